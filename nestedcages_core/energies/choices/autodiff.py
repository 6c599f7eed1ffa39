"""Automatic differentiation: second-order forward mode with numpy functions (Griewank & Walther 2008, chapter 3).

A jet is one number per element, with its gradient and Hessian with respect to the k coordinates of the element's
corners. Formulas of the functions below work on jets as on arrays:

>>> a, b = points_of(np.array([[[0.0, 0.0], [3.0, 4.0]]]))    # one element with two corners
>>> length = (b - a).length()
>>> length.value, length.gradient[0]
(array([5.]), array([-0.6, -0.8,  0.6,  0.8]))
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ...geometry.arrays import FloatArray

Number: TypeAlias = "Jet | FloatArray"
"""One number per element: a jet where derivatives are wanted, else an array (E,)."""


class Jet(NDArrayOperatorsMixin):
    """E numbers with first and second derivatives with respect to the k coordinates of their element."""

    def __init__(self, value: FloatArray, gradient: FloatArray, hessian: FloatArray) -> None:
        """value: (E,). gradient: (E, k). hessian: (E, k, k), symmetric."""
        self.value = value
        self.gradient = gradient
        self.hessian = hessian

    @classmethod
    def unknowns(cls, coordinates: FloatArray) -> list[Jet]:
        """The k coordinates (E, k) as jets: the independent variables."""
        count, k = coordinates.shape
        zero = np.zeros((count, k, k))
        unit = np.eye(k)
        return [cls(coordinates[:, i], np.broadcast_to(unit[i], (count, k)), zero) for i in range(k)]

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Jet:
        """Apply a numpy function; TypeError without a derivative rule."""
        rule = RULES.get(ufunc)
        if rule is None or method != "__call__" or keywords:
            raise TypeError(
                f"np.{ufunc.__name__} has no derivative rule; write the energy with {', '.join(sorted(NAMES))}."
            )
        return rule(*inputs)

    def __getitem__(self, elements: Any) -> Jet:
        """The jets of some elements."""
        return Jet(self.value[elements], self.gradient[elements], self.hessian[elements])

    def through(self, value: FloatArray, first: FloatArray, second: FloatArray) -> Jet:
        """f of this jet, given f and its first two derivatives (E,): ∂²f = f' ∂²u + f'' ∂u ∂uᵀ."""
        outer = self.gradient[:, :, None] * self.gradient[:, None, :]
        return Jet(
            value,
            first[:, None] * self.gradient,
            first[:, None, None] * self.hessian + second[:, None, None] * outer,
        )


@dataclass(frozen=True, eq=False)
class Point:
    """A point or vector of the plane per element."""

    x: Number
    y: Number

    def __add__(self, other: Point) -> Point:
        return Point(self.x + other.x, self.y + other.y)

    def __sub__(self, other: Point) -> Point:
        return Point(self.x - other.x, self.y - other.y)

    def __mul__(self, factor: Number | float) -> Point:
        return Point(self.x * factor, self.y * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Number | float) -> Point:
        return Point(self.x / divisor, self.y / divisor)

    def dot(self, other: Point) -> Number:
        """x x' + y y'."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: Point) -> Number:
        """x y' - y x': the area of the parallelogram, positive if the other vector is to the left of this one."""
        return self.x * other.y - self.y * other.x

    def length(self) -> Number:
        """√(x² + y²)."""
        return np.sqrt(self.dot(self))


def points_of(corners: FloatArray) -> tuple[Point, ...]:
    """The corners (E, k, 2) of elements as k points of jets, whose unknowns are x, y of the first, then the second."""
    jets = Jet.unknowns(corners.reshape(len(corners), -1))
    return tuple(Point(x, y) for x, y in zip(jets[::2], jets[1::2], strict=True))


def plain_points_of(corners: FloatArray) -> tuple[Point, ...]:
    """The corners (E, k, 2) of elements as k points of plain arrays, without derivatives."""
    return tuple(Point(corners[:, i, 0], corners[:, i, 1]) for i in range(corners.shape[1]))


# Derivative rules of the numpy functions


def _add(u: Any, v: Any) -> Jet:
    if not isinstance(u, Jet):
        u, v = v, u
    if not isinstance(v, Jet):
        return Jet(u.value + v, u.gradient, u.hessian)
    return Jet(u.value + v.value, u.gradient + v.gradient, u.hessian + v.hessian)


def _multiply(u: Any, v: Any) -> Jet:
    if not isinstance(u, Jet):
        u, v = v, u
    if not isinstance(v, Jet):
        factor = np.broadcast_to(v, u.value.shape)
        return Jet(factor * u.value, factor[:, None] * u.gradient, factor[:, None, None] * u.hessian)
    mixed = u.gradient[:, :, None] * v.gradient[:, None, :]
    return Jet(
        u.value * v.value,
        u.value[:, None] * v.gradient + v.value[:, None] * u.gradient,
        u.value[:, None, None] * v.hessian + v.value[:, None, None] * u.hessian + mixed + mixed.transpose(0, 2, 1),
    )


def _divide(u: Any, v: Any) -> Jet:
    return _multiply(u, np.reciprocal(v if isinstance(v, Jet) else np.asarray(v, np.float64)))


def _power(u: Any, exponent: Any) -> Jet:
    """u^p for a number p, or e^(p log u) where p is a jet."""
    if isinstance(exponent, Jet):
        return np.exp(_multiply(exponent, np.log(u)))  # type: ignore[no-any-return]
    base: Jet = u
    p, x = np.broadcast_to(np.asarray(exponent, np.float64), base.value.shape), base.value
    # the factors p and p (p - 1) vanish where x^(p - 1) and x^(p - 2) need not exist
    first = np.where(p == 0.0, 0.0, p * x ** np.where(p == 0.0, 1.0, p - 1.0))
    flat = (p == 0.0) | (p == 1.0)
    second = np.where(flat, 0.0, p * (p - 1.0) * x ** np.where(flat, 1.0, p - 2.0))
    return base.through(x**p, first, second)


def _arctan2(y: Any, x: Any) -> Jet:
    """The angle of (x, y), with the derivatives of arctan(y / x) or arctan(-x / y), by the larger divisor."""
    y, x = _lifted(y, x), _lifted(x, y)
    flat = np.abs(x.value) >= np.abs(y.value)
    part: Any = np.arctan(_divide(_choose(flat, y, -x), _choose(flat, x, y)))
    return Jet(np.arctan2(y.value, x.value), part.gradient, part.hessian)


def _choose(first: Any, u: Any, v: Any) -> Jet:
    """u where ``first`` (E,) is true, v elsewhere; at least one of them a jet."""
    u, v = _lifted(u, v), _lifted(v, u)
    return Jet(
        np.where(first, u.value, v.value),
        np.where(first[:, None], u.gradient, v.gradient),
        np.where(first[:, None, None], u.hessian, v.hessian),
    )


def _lifted(u: Any, like: Any) -> Jet:
    """u as a jet: a number becomes a constant of the size of the other jet."""
    if isinstance(u, Jet):
        return u
    value = np.broadcast_to(np.asarray(u, np.float64), like.value.shape)
    return Jet(value, np.zeros_like(like.gradient), np.zeros_like(like.hessian))


def _value_of(u: Any) -> Any:
    return u.value if isinstance(u, Jet) else u


DERIVATIVES: dict[np.ufunc, Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]] = {
    np.reciprocal: lambda x, y: (-(y**2), 2.0 * y**3),
    np.sqrt: lambda x, y: (0.5 / y, -0.25 / (y * x)),
    np.exp: lambda x, y: (y, y),
    np.log: lambda x, y: (1.0 / x, -((1.0 / x) ** 2)),
    np.sin: lambda x, y: (np.cos(x), -y),
    np.cos: lambda x, y: (-np.sin(x), -y),
    np.arctan: lambda x, y: (1.0 / (1.0 + x**2), -2.0 * x * (1.0 / (1.0 + x**2)) ** 2),
}
"""The first two derivatives of functions y(x) of one variable."""


def _through(ufunc: np.ufunc, u: Jet) -> Jet:
    value = ufunc(u.value)
    return u.through(value, *DERIVATIVES[ufunc](u.value, value))


def _sign(u: Jet) -> FloatArray:
    return np.where(u.value < 0.0, -1.0, 1.0)


RULES: dict[np.ufunc, Callable[..., Jet]] = {
    np.add: _add,
    np.subtract: lambda u, v: _add(u, -v),
    np.multiply: _multiply,
    np.divide: _divide,
    np.negative: lambda u: Jet(-u.value, -u.gradient, -u.hessian),
    np.positive: lambda u: u,
    np.power: _power,
    np.float_power: _power,
    np.square: lambda u: _multiply(u, u),
    np.arctan2: _arctan2,
    np.hypot: lambda u, v: np.sqrt(_add(np.square(u), np.square(v))),
    np.absolute: lambda u: _multiply(u, _sign(u)),
    np.maximum: lambda u, v: _choose(_value_of(u) >= _value_of(v), u, v),
    np.minimum: lambda u, v: _choose(_value_of(u) <= _value_of(v), u, v),
    **{ufunc: partial(_through, ufunc) for ufunc in DERIVATIVES},
}
"""Derivative rules by numpy function."""

NAMES = frozenset(f"np.{ufunc.__name__}" for ufunc in RULES)
