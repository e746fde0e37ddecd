"""What modules share: arrays, and what they need of a trajectory without knowing who made it."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from polhode._scenes import Scene

Array = npt.NDArray[np.float64]


@runtime_checkable
class Solved(Protocol):
    """A scene solved by a method, as `Trajectory` is: it knows its scene, and writes itself as a trajectory file."""

    _native: Any
    scene: Scene
    method: str

    def csv(self) -> str: ...


class Sampled(Solved, Protocol):
    """One whose samples are asked for, too."""

    t: Array  #: s
    q: Array  #: (w, x, y, z), body to world
    p: Array  #: m, centre of mass, world axes


class SeriesOfErrors(Protocol):
    """Errors of a trajectory over time, as `Errors` has them."""

    trajectory: Sampled
    t: Array  #: s
    series: dict[str, Array]
