"""Types that the modules share: arrays, and protocols of trajectories that do not depend on the class."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from polhode._scenes import Scene

Array = npt.NDArray[np.float64]


@runtime_checkable
class Solved(Protocol):
    """A scene solved by a method, such as `Trajectory`. It has its scene and can be written as a trajectory file."""

    _native: Any
    scene: Scene
    method: str

    def csv(self) -> str: ...


class Sampled(Solved, Protocol):
    """A solved scene with access to its samples."""

    t: Array  #: s
    q: Array  #: (w, x, y, z), body to world
    p: Array  #: m, centre of mass, world axes


class SeriesOfErrors(Protocol):
    """Errors of a trajectory over time, such as `Errors`."""

    trajectory: Sampled
    t: Array  #: s
    series: dict[str, Array]
