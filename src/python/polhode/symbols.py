"""Formulas of scenes from Python operators: time, state and functions of the formula language as Python objects.

An operator or function on a `Formula` makes a longer `Formula`. Its text is what a scene file contains, so a load made
this way has a reference solution, exact Jacobians and Taylor series like a load in a file. The reader of scenes checks
types and names when the scene is used.

Examples
--------
>>> import polhode
>>> from polhode.symbols import clamp, parameter, t, w
>>> print(-parameter("c") * w * (1 + t) ** 2)
-c*w*(1 + t)^2
>>> scene = polhode.scene("free_asymmetric").copy(duration=2, parameters={"c": 0.1})
>>> scene.loads = [{"type": "torque", "frame": "body", "formula": -parameter("c") * w}]
>>> polhode.solve(scene, samples=4).status
'ok'
>>> print([clamp(-3 * w.x, -1, 1), 0, 0][0])
clamp(-3*w.x, -1, 1)
"""

from __future__ import annotations

import builtins
import math
import numbers
import re
from collections.abc import Sequence
from typing import Any, Union

# how tightly an operation binds; an operand that binds less tightly is put in brackets
_OR, _AND, _NOT, _COMPARISON, _SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(9)

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


class Formula:
    """A formula of time and state, such as ``-0.1 * w``.

    Operators: ``+ - * / **`` and comparisons, with formulas, numbers, and sequences of three of them (vectors).
    Conditions are joined by ``&``, ``|`` and ``~``. `str` returns the text for a scene file.

    Attributes
    ----------
    x, y, z : Formula
        The components of a vector.
    """

    __slots__ = ("_text", "_binding")
    _text: str
    _binding: int

    # numpy arrays and numbers leave operators to this class
    __array_ufunc__ = None

    def __init__(self, text: str, binding: int = _OR) -> None:
        self._text = text
        self._binding = binding

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<polhode.symbols.Formula {self._text}>"

    def __bool__(self) -> bool:
        raise TypeError(f"the formula {self._text} has no truth value; join conditions with &, | and ~, write "
                        "a < b < c as (a < b) & (b < c), and choose with if_(condition, a, b)")

    def __iter__(self) -> Any:
        raise TypeError(f"the formula {self._text} cannot be iterated; use its components .x, .y and .z")

    @property
    def x(self) -> Formula:
        """The first component of a vector."""
        return Formula(_bracketed(self, _ATOM) + ".x", _ATOM)

    @property
    def y(self) -> Formula:
        """The second component of a vector."""
        return Formula(_bracketed(self, _ATOM) + ".y", _ATOM)

    @property
    def z(self) -> Formula:
        """The third component of a vector."""
        return Formula(_bracketed(self, _ATOM) + ".z", _ATOM)

    def __add__(self, other: Operand) -> Formula:
        return _joined(self, " + ", other, _SUM)

    def __radd__(self, other: Operand) -> Formula:
        return _joined(other, " + ", self, _SUM)

    def __sub__(self, other: Operand) -> Formula:
        return _joined(self, " - ", other, _SUM)

    def __rsub__(self, other: Operand) -> Formula:
        return _joined(other, " - ", self, _SUM)

    def __mul__(self, other: Operand) -> Formula:
        return _joined(self, "*", other, _PRODUCT)

    def __rmul__(self, other: Operand) -> Formula:
        return _joined(other, "*", self, _PRODUCT)

    def __truediv__(self, other: Operand) -> Formula:
        return _joined(self, "/", other, _PRODUCT)

    def __rtruediv__(self, other: Operand) -> Formula:
        return _joined(other, "/", self, _PRODUCT)

    def __pow__(self, other: Operand) -> Formula:
        return Formula(f"{_bracketed(self, _ATOM)}^{_bracketed(formula(other), _POWER)}", _POWER)

    def __rpow__(self, other: Operand) -> Formula:
        return formula(other).__pow__(self)

    def __neg__(self) -> Formula:
        return Formula("-" + _bracketed(self, _POWER), _SIGN)

    def __pos__(self) -> Formula:
        return self

    def __abs__(self) -> Formula:
        return _call("abs", self)

    def __lt__(self, other: Operand) -> Formula:
        return _compared(self, "<", other)

    def __le__(self, other: Operand) -> Formula:
        return _compared(self, "<=", other)

    def __gt__(self, other: Operand) -> Formula:
        return _compared(self, ">", other)

    def __ge__(self, other: Operand) -> Formula:
        return _compared(self, ">=", other)

    def __and__(self, other: Formula) -> Formula:
        return _joined(self, " and ", other, _AND)

    def __or__(self, other: Formula) -> Formula:
        return _joined(self, " or ", other, _OR)

    def __invert__(self) -> Formula:
        return Formula("not " + _bracketed(self, _NOT), _NOT)


#: Values that formulas are combined with.
Operand = Union[Formula, float, Sequence[Any]]


def formula(value: Operand) -> Formula:
    """Returns a number, or a sequence of three numbers or formulas (a vector), as a formula.

    Parameters
    ----------
    value : Formula, float or sequence of three of them
        The value.

    Returns
    -------
    Formula
        The formula. The text of a number reads back to the same binary64.

    Raises
    ------
    TypeError
        If the value has another type.
    ValueError
        If a number is not finite, or a sequence has not three components.

    Examples
    --------
    >>> print(formula([0, -1.5, t]))
    [0, -1.5, t]
    """
    if isinstance(value, Formula):
        return value
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        if not math.isfinite(value):
            raise ValueError(f"a formula cannot contain {value}; give a finite number")
        number = float(value)
        text = str(int(number)) if number.is_integer() and builtins.abs(number) < 2.0**53 else repr(number)
        # the text of a negative number is a sign and a number
        return Formula(text, _SIGN if text.startswith("-") else _ATOM)
    if not isinstance(value, (str, bytes)) and hasattr(value, "__len__") and hasattr(value, "__getitem__"):
        components: Any = value
        if len(components) != 3:
            raise ValueError(f"a vector in a formula has three components, not {len(components)}")
        return Formula(f"[{', '.join(str(formula(component)) for component in components)}]", _ATOM)
    raise TypeError(f"a formula cannot contain a {type(value).__name__}; give a formula, a number, or three of them"
                    + ("; use parameter(name) for a name" if isinstance(value, str) else ""))


def _bracketed(value: Formula, binding: int) -> str:
    return value._text if value._binding >= binding else f"({value._text})"


def _joined(left: Operand, operator: str, right: Operand, binding: int) -> Formula:
    # operators group from the left
    a, b = formula(left), formula(right)
    return Formula(_bracketed(a, binding) + operator + _bracketed(b, binding + 1), binding)


def _compared(left: Operand, operator: str, right: Operand) -> Formula:
    a, b = formula(left), formula(right)
    return Formula(f"{_bracketed(a, _SUM)} {operator} {_bracketed(b, _SUM)}", _COMPARISON)


def _call(name: str, *arguments: Operand) -> Formula:
    return Formula(f"{name}({', '.join(str(formula(argument)) for argument in arguments)})", _ATOM)


def parameter(name: str) -> Formula:
    """Returns the value of a parameter of the scene, or of a definition in its ``let``.

    Parameters
    ----------
    name : str
        A key of the scene's ``parameters`` or ``let``.

    Returns
    -------
    Formula
        The value.

    Raises
    ------
    ValueError
        If the name is not an identifier.

    Examples
    --------
    >>> print(2 * parameter("k"))
    2*k
    """
    if not _IDENTIFIER.fullmatch(name):
        raise ValueError(f"the name {name!r} is not an identifier; begin with a letter or \"_\", and use letters, "
                         "digits and \"_\"")
    return Formula(name, _ATOM)


def _name(name: str) -> str:
    if '"' in name:
        raise ValueError(f"the name {name!r} contains a quotation mark, which formulas cannot represent")
    return name if _IDENTIFIER.fullmatch(name) else f'"{name}"'


def quantity(name: str, member: str) -> Formula:
    """Returns a quantity of a body or a joint in a scene of several bodies.

    Parameters
    ----------
    name : str
        The name of a body or of a joint.
    member : str
        Body: ``"p"``, ``"q"``, ``"v"``, ``"w"``, ``"w_W"`` or ``"mass"``. Revolute joint: ``"angle"`` or ``"rate"``.
        Prismatic joint: ``"displacement"`` or ``"speed"``.

    Returns
    -------
    Formula
        The quantity.

    Raises
    ------
    ValueError
        If the name contains a quotation mark, or if the member is not an identifier.

    Examples
    --------
    >>> print(-8 * quantity("elbow", "rate"))
    -8*elbow.rate
    """
    if not _IDENTIFIER.fullmatch(member):
        raise ValueError(f"the member {member!r} is not an identifier; give p, w, angle, ..")
    return Formula(f"{_name(name)}.{member}", _ATOM)


#: Time, s.
t = Formula("t", _ATOM)
#: Attitude, body axes to world axes; only as an argument of a function.
q = Formula("q", _ATOM)
#: Angular velocity, body axes, rad/s.
w = Formula("w", _ATOM)
#: Angular velocity, world axes, rad/s.
w_W = Formula("w_W", _ATOM)
#: Position of the centre of mass, world axes, m.
p = Formula("p", _ATOM)
#: Velocity of the centre of mass, world axes, m/s.
v = Formula("v", _ATOM)
#: Mass of the body, kg.
mass = Formula("mass", _ATOM)
#: Ratio of a circle's circumference to its diameter.
pi = Formula("pi", _ATOM)


def sqrt(x: Operand) -> Formula:
    """Returns the square root."""
    return _call("sqrt", x)


def cbrt(x: Operand) -> Formula:
    """Returns the real cube root."""
    return _call("cbrt", x)


def exp(x: Operand) -> Formula:
    """Returns e to the power x."""
    return _call("exp", x)


def log(x: Operand) -> Formula:
    """Returns the natural logarithm."""
    return _call("log", x)


def sin(x: Operand) -> Formula:
    """Returns the sine of an angle in rad."""
    return _call("sin", x)


def cos(x: Operand) -> Formula:
    """Returns the cosine of an angle in rad."""
    return _call("cos", x)


def tan(x: Operand) -> Formula:
    """Returns the tangent of an angle in rad."""
    return _call("tan", x)


def asin(x: Operand) -> Formula:
    """Returns the arcsine, rad."""
    return _call("asin", x)


def acos(x: Operand) -> Formula:
    """Returns the arccosine, rad."""
    return _call("acos", x)


def atan(x: Operand) -> Formula:
    """Returns the arctangent, rad."""
    return _call("atan", x)


def atan2(y: Operand, x: Operand) -> Formula:
    """Returns the angle of the point (x, y) in (-pi, pi], rad."""
    return _call("atan2", y, x)


def sinh(x: Operand) -> Formula:
    """Returns the hyperbolic sine."""
    return _call("sinh", x)


def cosh(x: Operand) -> Formula:
    """Returns the hyperbolic cosine."""
    return _call("cosh", x)


def tanh(x: Operand) -> Formula:
    """Returns the hyperbolic tangent."""
    return _call("tanh", x)


def hypot(x: Operand, y: Operand) -> Formula:
    """Returns sqrt(x^2 + y^2)."""
    return _call("hypot", x, y)


def abs(x: Operand) -> Formula:
    """Returns the absolute value; switches at x = 0."""
    return _call("abs", x)


def sign(x: Operand) -> Formula:
    """Returns -1, 0 or 1; switches at x = 0."""
    return _call("sign", x)


def min(x: Operand, y: Operand) -> Formula:
    """Returns the smaller value; switches at x = y."""
    return _call("min", x, y)


def max(x: Operand, y: Operand) -> Formula:
    """Returns the larger value; switches at x = y."""
    return _call("max", x, y)


def clamp(x: Operand, low: Operand, high: Operand) -> Formula:
    """Returns x limited to the range; switches at both limits."""
    return _call("clamp", x, low, high)


def step(x: Operand) -> Formula:
    """Returns 0 for x < 0, else 1; switches at x = 0."""
    return _call("step", x)


def if_(condition: Formula, a: Operand, b: Operand) -> Formula:
    """Returns a if the condition is true, else b; switches where a comparison changes."""
    return _call("if", condition, a, b)


def hold(x: Operand, h: Operand) -> Formula:
    """Returns the value of a scalar or a vector at the last multiple of h, s: a sampled signal (zero-order hold)."""
    return _call("hold", x, h)


def dot(a: Operand, b: Operand) -> Formula:
    """Returns the dot product of two vectors."""
    return _call("dot", a, b)


def cross(a: Operand, b: Operand) -> Formula:
    """Returns the cross product of two vectors."""
    return _call("cross", a, b)


def norm(a: Operand) -> Formula:
    """Returns the length of a vector."""
    return _call("norm", a)


def unit(a: Operand) -> Formula:
    """Returns a vector divided by its length."""
    return _call("unit", a)


def to_body(a: Operand) -> Formula:
    """Returns a vector in world axes, converted to body axes."""
    return _call("to_body", a)


def to_world(a: Operand) -> Formula:
    """Returns a vector in body axes, converted to world axes."""
    return _call("to_world", a)


def inertia(a: Operand) -> Formula:
    """Returns I a with the inertia tensor about the centre of mass, body axes."""
    return _call("inertia", a)


def table(name: str, x: Operand) -> Formula:
    """Returns the value of a table of the scene at x; switches at the points of the table."""
    return _call("table", parameter(name), x)


def at(body: str, point: Operand) -> Formula:
    """Returns the position of a point of a body of several, given from its origin in its axes; world axes, m."""
    return Formula(f"at({_name(body)}, {formula(point)})", _ATOM)


def velocity_at(body: str, point: Operand) -> Formula:
    """Returns the velocity of a point of a body of several; world axes, m/s."""
    return Formula(f"velocity_at({_name(body)}, {formula(point)})", _ATOM)


def _quaternion(q0: Sequence[float]) -> str:
    if len(q0) != 4:
        raise ValueError(f"a quaternion has four components (w, x, y, z), not {len(q0)}")
    return f"[{', '.join(str(formula(component)) for component in q0)}]"


def rotation_error(q0: Sequence[float]) -> Formula:
    """Returns 2 sign(r_w) (r_x, r_y, r_z) of r = q0* q, body axes; switches at r_w = 0."""
    return Formula(f"rotation_error({_quaternion(q0)})", _ATOM)


def rotation_vector(q0: Sequence[float]) -> Formula:
    """Returns axis times angle of r = q0* q, rad, body axes; undefined at r = 1; switches at r_w = 0."""
    return Formula(f"rotation_vector({_quaternion(q0)})", _ATOM)


__all__ = sorted(name for name, value in globals().items()
                 if not name.startswith("_") and (isinstance(value, Formula)
                                                  or getattr(value, "__module__", "") == __name__))
