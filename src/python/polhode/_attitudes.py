"""Conversions of motions: matrices, rotations, Euler angles, rotation vectors, tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._types import Array

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from scipy.spatial.transform import Rotation

#: Names of sequences of Euler angles besides those made of axes.
_SEQUENCES = {"yaw-pitch-roll": "ZYX", "roll-pitch-yaw": "xyz", "proper": "ZXZ"}

#: Columns of a trajectory file after the time and the body.
_COLUMNS = ["qw", "qx", "qy", "qz", "wx", "wy", "wz", "px", "py", "pz", "vx", "vy", "vz"]


def _unit(q: npt.ArrayLike) -> Array:
    values: Array = np.asarray(q, dtype=np.float64)
    unit: Array = values / np.linalg.norm(values, axis=-1, keepdims=True)
    return unit


def matrices_of(q: npt.ArrayLike) -> Array:
    """Returns rotation matrices (.., 3, 3) of quaternions (.., 4), which need not be normalised."""
    w, x, y, z = np.moveaxis(_unit(q), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _sequence(name: str) -> tuple[list[int], bool]:
    """Returns the axes of a sequence, and whether it refers to world axes. Raises InputError."""
    axes = _SEQUENCES.get(name, name)
    letters = axes.lower()
    if len(axes) != 3 or axes not in (letters, axes.upper()) or set(letters) - set("xyz") or \
            letters[0] == letters[1] or letters[1] == letters[2]:
        raise _polhode.InputError(
            f"{name!r} is no sequence of Euler angles; give three axes such as \"ZYX\" (axes of the body) or \"xyz\" "
            f"(axes of the world), or one of {', '.join(_SEQUENCES)}")
    return ["xyz".index(letter) for letter in letters], axes == letters


def _euler_angles(q: npt.ArrayLike, sequence: str) -> Array:
    """Computes Euler angles by Bernardes & Viollet (2022, PLoS ONE 17, e0276302)."""
    axes, in_world = _sequence(sequence)
    i, j, k = axes if in_world else axes[::-1]
    proper = i == k
    if proper:
        k = 3 - i - j
    sign = (i - j) * (j - k) * (k - i) / 2
    unit = _unit(q)
    w, x, y, z = unit[..., 0], unit[..., 1 + i], unit[..., 1 + j], unit[..., 1 + k] * sign
    a, b, c, d = (w, x, y, z) if proper else (w - y, x + z, y + w, z - x)
    middle: Array = 2.0 * np.arctan2(np.hypot(c, d), np.hypot(a, b))
    half_sum, half_difference = np.arctan2(b, a), np.arctan2(d, c)
    # about axes of the world the first angle is that of the difference, about axes of the body that of the sum
    first: Array = half_sum - half_difference
    last: Array = half_sum + half_difference
    if not in_world:
        first, last = last, first
    # a middle angle of 0 or pi determines only the sum or the difference of the others: the last angle is zero
    flat, turned = np.hypot(c, d) < 1e-7, np.hypot(a, b) < 1e-7
    first = np.where(flat, 2 * half_sum, np.where(turned, (-2 if in_world else 2) * half_difference, first))
    last = np.where(flat | turned, 0.0, last)
    if not proper:
        middle = middle - np.pi / 2
        if in_world:
            last = last * sign
        else:
            first = first * sign
    angles = np.stack([first, middle, last], axis=-1)
    return np.where(angles > np.pi, angles - 2 * np.pi, np.where(angles <= -np.pi, angles + 2 * np.pi, angles))


class Attitudes:
    """Conversions that trajectories and the motions of single bodies share. Subclasses have t, q, w, p and v."""

    if TYPE_CHECKING:
        t: Array
        q: Array
        w: Array
        p: Array
        v: Array

    def _centers(self) -> Array:
        """Returns the centre of mass of each body from its origin, body axes, in the shape of p without time."""
        raise NotImplementedError

    def _bodies(self) -> list[str]:
        """Returns the names of the bodies along the second axis of the arrays; empty if there is none."""
        raise NotImplementedError

    def matrices(self) -> Array:
        """Returns the rotation matrices from body to world axes.

        Returns
        -------
        ndarray, shape (n, 3, 3) or (n, bodies, 3, 3)
        """
        return matrices_of(self.q)

    def frames(self, origin: str = "body") -> Array:
        """Returns the poses as homogeneous matrices, which map points of the body to the world.

        Parameters
        ----------
        origin : {"body", "center_of_mass"}, optional
            Origin of the body's frame: its own origin, from which the scene gives points, or its centre of mass.

        Returns
        -------
        ndarray, shape (n, 4, 4) or (n, bodies, 4, 4)
            ``frames @ [x, y, z, 1]`` is the world position of the body's point (x, y, z).

        Examples
        --------
        >>> import polhode
        >>> motion = polhode.solve("mechanisms/double_pendulum", samples=10)
        >>> motion.frames().shape, motion["upper"].frames().shape
        ((11, 2, 4, 4), (11, 4, 4))
        """
        if origin not in ("body", "center_of_mass"):
            raise _polhode.InputError(f"origin is {origin!r}; give \"body\" or \"center_of_mass\"")
        R = matrices_of(self.q)
        frames = np.zeros(R.shape[:-2] + (4, 4))
        frames[..., :3, :3] = R
        frames[..., :3, 3] = self.p
        if origin == "body":
            frames[..., :3, 3] -= (R @ self._centers()[..., None])[..., 0]
        frames[..., 3, 3] = 1
        return frames

    def rotations(self) -> Rotation:
        """Returns the attitudes as SciPy's rotations, body to world.

        Returns
        -------
        scipy.spatial.transform.Rotation
            One rotation per sample; for several bodies one per sample and body, in this order.
        """
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(np.roll(_unit(self.q).reshape(-1, 4), -1, axis=1))

    def rotation_vectors(self) -> Array:
        """Returns the attitudes as rotation vectors: the axis times the angle, which is at most pi.

        Returns
        -------
        ndarray, shape (n, 3) or (n, bodies, 3)
            rad.
        """
        unit = _unit(self.q)
        unit = np.where(unit[..., :1] < 0, -unit, unit)
        length = np.linalg.norm(unit[..., 1:], axis=-1, keepdims=True)
        small = length < 1e-150
        angle = 2 * np.arctan2(length, unit[..., :1])
        return np.where(small, 2.0, angle / np.where(small, 1.0, length)) * unit[..., 1:]  # type: ignore[no-any-return]

    def euler(self, sequence: str = "ZYX", *, degrees: bool = False) -> Array:
        """Returns Euler angles of a named sequence, in the order of its axes.

        Parameters
        ----------
        sequence : str, optional
            Three axes: upper case for successive rotations about axes of the body ("ZYX": yaw, pitch, roll), lower
            case about axes of the world. Also "yaw-pitch-roll" (ZYX), "roll-pitch-yaw" (xyz) and "proper" (ZXZ).
        degrees : bool, optional
            Return degrees. Default: rad.

        Returns
        -------
        ndarray, shape (n, 3) or (n, bodies, 3)
            First and third angle in (-pi, pi]. If the middle angle is singular, the third angle is zero.
        """
        angles = _euler_angles(self.q, sequence)
        return np.degrees(angles) if degrees else angles

    def to_pandas(self) -> pd.DataFrame:
        """Returns a table with the columns of a trajectory file, and ``body`` for several bodies.

        Returns
        -------
        pandas.DataFrame
            One row per sample and body.

        Examples
        --------
        >>> import polhode
        >>> list(polhode.solve("mechanisms/double_pendulum", samples=10).to_pandas().columns[:4])
        ['t', 'body', 'qw', 'qx']
        """
        import pandas as pd

        blocks = [np.asarray(a).reshape(-1, a.shape[-1]) for a in (self.q, self.w, self.p, self.v)]
        table = pd.DataFrame(np.hstack(blocks), columns=_COLUMNS)
        bodies = self._bodies()
        if bodies:
            table.insert(0, "body", np.tile(np.array(bodies, dtype=object), len(self.t)))
        table.insert(0, "t", np.repeat(self.t, max(1, len(bodies))))
        return table

    def to_xarray(self) -> xr.Dataset:
        """Returns a labelled data set with the variables q, w, p and v over time, body and component.

        Returns
        -------
        xarray.Dataset
            Dimension ``t`` (s), ``body`` for several bodies, ``quaternion`` (w, x, y, z) and ``axis`` (x, y, z).

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        try:
            import xarray as xr
        except ImportError as error:
            raise ImportError("to_xarray() needs xarray; install it, or use to_pandas()") from error
        bodies = self._bodies() if self.q.ndim > 2 else []
        dimensions = ["t", "body"] if bodies else ["t"]
        units = {"q": "", "w": "rad/s", "p": "m", "v": "m/s"}
        variables: dict[str, Any] = {}
        for name, unit in units.items():
            last = "quaternion" if name == "q" else "axis"
            variables[name] = ([*dimensions, last], np.asarray(getattr(self, name)), {"units": unit})
        coordinates: dict[str, Any] = {"t": ("t", np.asarray(self.t), {"units": "s"}),
                                       "quaternion": list("wxyz"), "axis": list("xyz")}
        if bodies:
            coordinates["body"] = bodies
        return xr.Dataset(variables, coords=coordinates)


class BodyMotion(Attitudes):
    """The motion of one body of several at the samples.

    Attributes
    ----------
    name : str
        Name of the body.
    t : ndarray, shape (n,)
        Times, s.
    q : ndarray, shape (n, 4)
        Attitude (w, x, y, z), body to world.
    w, w_B : ndarray, shape (n, 3)
        Angular velocity, world and body axes, rad/s.
    p, v : ndarray, shape (n, 3)
        Position and velocity of the centre of mass, world axes, m and m/s.
    """

    def __init__(self, name: str, t: Array, q: Array, w: Array, w_B: Array, p: Array, v: Array,
                 center: Array) -> None:
        self.name = name
        self.t, self.q, self.w, self.w_B, self.p, self.v = t, q, w, w_B, p, v
        self._center = center

    def _centers(self) -> Array:
        return self._center

    def _bodies(self) -> list[str]:
        return []

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return f"<polhode.BodyMotion {self.name}: {len(self.t)} samples>"
