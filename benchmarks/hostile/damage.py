"""Numbers that readers trip over, and documents that were damaged on the way: what all grammars build on."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

Draw = Any

EXTREME = [
    "1e999", "-1e999", "1e308", "1e-320", "5e-324", "nan", "inf", "-0", "", "-", ".", "1e", "0x10", "1_0", "٣", "--1",
    "1e99999999999", "9" * 400, "0." + "0" * 400 + "1", "1,5", "½",
]  # fmt: skip
"""Numbers that readers trip over, and texts that are none."""


def rarely(draw: Draw, odds: int) -> bool:
    """About once in so many times and one; zero and the largest number are drawn more often than others."""
    return bool(draw(st.integers(0, odds)) == odds // 2)


@st.composite
def mostly(draw: Draw, often: st.SearchStrategy[Any], seldom: st.SearchStrategy[Any], odds: int) -> Any:
    """The second strategy once in so many times and one."""
    return draw(seldom if rarely(draw, odds) else often)


plain_numbers = st.one_of(st.integers(-20, 20).map(str), st.floats(-100, 100).map(lambda x: f"{x:.6g}"))
numbers = mostly(plain_numbers, st.sampled_from(EXTREME), 20)
coordinates = st.one_of(
    st.integers(-20, 20),
    st.floats(-10, 10),
    st.sampled_from([0.0, -0.0, 1e-200, 1e-310, 5e-324, 1e-160, 1e-16, 1 + 2**-52, 1e16, 1e149, 1e150, 1e151, 1e308]),
)


@st.composite
def mutated(draw: Draw, documents: st.SearchStrategy[bytes]) -> bytes:
    """A document with a few bytes replaced, removed or repeated, or its end cut off; often untouched."""
    data = bytearray(draw(documents))
    for _ in range(draw(st.sampled_from([0] * 9 + [1, 2, 5]))):
        if not data:
            break
        place, length = draw(st.integers(0, len(data) - 1)), draw(st.integers(1, 8))
        how = draw(st.integers(0, 3))
        if how == 0:
            data[place : place + length] = draw(st.binary(max_size=8))
        elif how == 1:
            del data[place : place + length]
        elif how == 2:
            data[place:place] = data[place : place + 20 * length]
        else:
            del data[place:]
    return bytes(data)
