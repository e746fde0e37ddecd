"""Joints of mechanisms: coordinates, rates and reactions by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _polhode
from polhode._html import table_html
from polhode._types import Array

if TYPE_CHECKING:
    import pandas as pd

#: The attributes of each type of joint, with the arrays that they are: (coordinate or rate, column or all).
_ATTRIBUTES: dict[str, dict[str, tuple[str, int | None]]] = {
    "revolute": {"angle": ("coordinate", 0), "rate": ("rates", 0)},
    "prismatic": {"displacement": ("coordinate", 0), "speed": ("rates", 0)},
    "universal": {"angles": ("coordinate", None), "rates": ("rates", None)},
    "spherical": {"q": ("coordinate", None), "angular_velocity": ("w", None)},
    "fixed": {},
}


def index_of(name: str, names: list[str], what: str) -> int:
    """Returns the index of a name. Raises InputError with the names that exist."""
    if name in names:
        return names.index(name)
    raise _polhode.InputError(f"there is no {what} {name!r}; the names are {', '.join(names) or 'none'}")


class JointMotion:
    """The motion of one joint at the samples.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times, s.
    name, type : str
        Name and type of the joint.
    angle, rate : ndarray, shape (n,)
        Revolute joint: angle with full revolutions, rad, and its rate, rad/s.
    displacement, speed : ndarray, shape (n,)
        Prismatic joint: m and m/s.
    angles, rates : ndarray, shape (n, 2)
        Universal joint: both angles, rad, and their rates, rad/s.
    q : ndarray, shape (n, 4)
        Spherical joint: the quaternion (w, x, y, z) of the child relative to its attitude at coordinate zero.
    angular_velocity : ndarray, shape (n, 3)
        Spherical joint: angular velocity of the child relative to the parent, child axes, rad/s.
    coordinates, coordinate_rates : ndarray, shape (n, k)
        All k coordinates of a joint of any type, and their time derivatives.
    """

    def __init__(self, t: Array, name: str, kind: str, coordinates: Array, rates: Array, w: Array) -> None:
        self.t = t
        self.name = name
        self.type = kind
        self.coordinates = coordinates
        self.coordinate_rates = rates
        self._blocks = {"coordinate": coordinates, "rates": rates, "w": w}

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_"):
            raise AttributeError(name)
        attributes = _ATTRIBUTES[self.type]
        if name not in attributes:
            raise AttributeError(f"a {self.type} joint has no {name}; it has "
                                 f"{', '.join(attributes) or 'no coordinates'}")
        block, column = attributes[name]
        values = self._blocks[block]
        return values if column is None else values[:, column]

    def __dir__(self) -> Iterator[str]:
        yield from super().__dir__()
        yield from _ATTRIBUTES[self.type]

    def __repr__(self) -> str:
        return f"<polhode.JointMotion {self.name}: {self.type}, {len(self.t)} samples>"


class Joints(Mapping[str, JointMotion]):
    """The motions of all joints of a trajectory, by name, in the scene's order.

    Examples
    --------
    >>> import polhode
    >>> motion = polhode.solve("mechanisms/double_pendulum", samples=10)
    >>> list(motion.joints), motion.joints["elbow"].angle.shape
    (['shoulder', 'elbow'], (11,))
    >>> float(motion.joints["shoulder"].angle[0])
    2.0
    """

    def __init__(self, t: Array, found: list[tuple[str, str, Array, Array, Array]]) -> None:
        self._t = t
        self._all = {name: JointMotion(t, name, kind, x, rates, w) for name, kind, x, rates, w in found}
        for motion in self._all.values():
            for block in motion._blocks.values():
                block.flags.writeable = False

    def __getitem__(self, name: str) -> JointMotion:
        index_of(name, list(self._all), "joint")
        return self._all[name]

    def __contains__(self, name: object) -> bool:
        return name in self._all

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def to_pandas(self) -> pd.DataFrame:
        """Returns a table ``t, joint, coordinate, rate``, with one row per coordinate, as ``polhode solve --joints``.

        Returns
        -------
        pandas.DataFrame
        """
        import pandas as pd

        rows = [
            (t, motion.name, coordinate, rate)
            for k, t in enumerate(self._t)
            for motion in self.values()
            for coordinate, rate in zip(motion.coordinates[k], motion.coordinate_rates[k])
        ]
        return pd.DataFrame(rows, columns=["t", "joint", "coordinate", "rate"])

    def __repr__(self) -> str:
        return "<polhode.Joints " + ", ".join(f"{m.name}: {m.type}" for m in self.values()) + ">"

    def _repr_html_(self) -> str:
        return table_html(["joint", "type", "attributes"],
                          [[m.name, m.type, ", ".join(_ATTRIBUTES[m.type])] for m in self.values()])


class Reactions(np.ndarray):  # type: ignore[type-arg]
    """The reactions of joints and loops at the samples: an array of shape (n, joints, 6) that is called with a name.

    The numbers are force (N) and torque (N m, about the child's point), world axes, that the parent exerts on the
    child. Without ``reactions=True`` in `polhode.solve`, or if the method does not compute them, the second length is
    0.

    Examples
    --------
    >>> import polhode
    >>> motion = polhode.solve("mechanisms/double_pendulum", samples=10, reactions=True)
    >>> motion.reactions("elbow").shape
    (11, 6)
    """

    _names: list[str]
    _method: str

    def __new__(cls, values: Array | None, samples: int, names: list[str], method: str) -> Reactions:
        made = np.asarray(np.empty((samples, 0, 6)) if values is None else values).view(cls)
        made._names = names
        made._method = method
        return made

    def __array_finalize__(self, source: Any) -> None:
        self._names = getattr(source, "_names", [])
        self._method = getattr(source, "_method", "")

    def __call__(self, name: str) -> Array:
        """Returns the reactions of one joint or loop.

        Parameters
        ----------
        name : str
            Name of a joint or loop.

        Returns
        -------
        ndarray, shape (n, 6)
            Force (N) and torque (N m), world axes.

        Raises
        ------
        InputError
            If there is no joint or loop of this name, or reactions were not computed.
        """
        place = index_of(name, self._names, "joint or loop")
        if self.ndim != 3 or self.shape[1] != len(self._names):
            raise _polhode.InputError(
                f"the reactions of joints were not computed by {self._method}; call solve(.., reactions=True) with "
                "taylor or another method in joint coordinates")
        return np.asarray(self)[:, place]
