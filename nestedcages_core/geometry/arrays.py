"""Array types of all signatures."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
"""Array of float64; shape and unit are documented where it is used."""

IntArray: TypeAlias = npt.NDArray[np.int64]
"""Array of indices."""

BoolArray: TypeAlias = npt.NDArray[np.bool_]
"""Array of truth values."""

AnyArray: TypeAlias = npt.NDArray[Any]
"""Array of unchecked content, before validation."""

TINY = float(np.finfo(np.float64).tiny)
"""Smallest normal float64: lower bound of divisors that may vanish."""

KEPT_MEMORY = 2**25 - 2**13
"""Bytes, a little less than the largest array after which glibc keeps what is freed: fresh pages took a fifth of the
time of a first cage. Nothing is written to it, so that it takes no memory itself."""

np.empty(KEPT_MEMORY, np.uint8)
