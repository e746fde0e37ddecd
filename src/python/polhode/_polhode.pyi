from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]

__version__: str

class InputError(ValueError):
    """A scene, a file, a name or a setting is at fault; one line names place, fault and remedy."""

class NoTruthError(RuntimeError):
    """There is no truth to judge by; the line says why."""

class LoadState:
    @property
    def t(self) -> float: ...
    @property
    def q(self) -> tuple[float, float, float, float]: ...
    @property
    def w_B(self) -> _Array: ...
    @property
    def p(self) -> _Array: ...
    @property
    def v(self) -> _Array: ...

class RightHandSide:
    def __call__(self, t: float, y: npt.ArrayLike) -> _Array: ...

class ReadScene:
    def __init__(
        self,
        text: str,
        file: str,
        directory: str,
        torques: list[tuple[Callable[[LoadState], Any], str, float | None, float | None]],
    ) -> None: ...
    @property
    def duration(self) -> float: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def joints(self) -> list[str]: ...
    def describe(self) -> str: ...
    def canonical(self) -> str: ...

class Settings:
    def __init__(
        self,
        step: float | None = None,
        tolerance: float | None = None,
        samples: int = 100,
        times: _Array = ...,
        max_steps: int = ...,
        max_evaluations: int = ...,
        max_seconds: float = ...,
    ) -> None: ...

class SolvedScene:
    t: _Array
    q: _Array
    w_B: _Array
    p: _Array
    v: _Array
    impact_times: list[float]
    status: str
    message: str
    steps: int
    rhs_evaluations: int
    counts: dict[str, int | None]
    seconds: float
    step: float
    method: str
    why: str
    tolerance: float | None
    scene: ReadScene
    def w(self) -> _Array: ...
    def reactions(self) -> _Array | None: ...
    def csv(self) -> str: ...

class SampleTimes:
    def __init__(self, samples: int, times: _Array) -> None: ...

class EnsembleSettings:
    def __init__(self, tolerance: float | None, threads: int, max_steps: int, max_seconds: float) -> None: ...

class Columns:
    def __init__(self, *blocks: _Array | None) -> None: ...

class SolvedBodies:
    q: _Array
    w_B: _Array
    p: _Array
    v: _Array
    seconds: float
    def __len__(self) -> int: ...
    def w(self) -> _Array: ...
    def failures(self) -> list[tuple[int, str, str]]: ...

def scene_text(name: str) -> tuple[str, str]: ...
def scene_names() -> list[str]: ...
def experiment_names() -> list[str]: ...
def experiment_text(name: str) -> str: ...
def method_description(name: str) -> str | None: ...
def solve(scene: ReadScene, method: str, settings: Settings, full: bool, reactions: bool) -> SolvedScene: ...
def trajectory_of(scene: ReadScene, made_by: str, times: _Array, rows: _Array) -> SolvedScene: ...
def decimals(scene: ReadScene, at: SampleTimes, digits: int, max_seconds: float) -> Any: ...
def certified(scene: ReadScene, at: SampleTimes, digits: int, max_seconds: float) -> Any: ...
def errors(solved: SolvedScene, digits: int, max_seconds: float) -> dict[str, Any]: ...
def check(
    scene: ReadScene, texts: list[tuple[str, str]], convention: str, limits: dict[str, str], explain: bool
) -> tuple[bool, str, str, str]: ...
def measures() -> list[dict[str, str]]: ...
def solve_bodies(scene: ReadScene, count: int, columns: Columns, settings: EnsembleSettings) -> SolvedBodies: ...
def solve_mechanisms(
    scene: ReadScene, table: str, samples: int, settings: EnsembleSettings
) -> tuple[_Array, list[str], list[str]]: ...
def add_method(
    name: str,
    documentation: str,
    source: str,
    order: int,
    conserves: str,
    control: str,
    identity: str,
    *,
    step: Callable[..., Any] | None,
    solve: Callable[..., Any] | None,
) -> None: ...
def methods() -> list[dict[str, Any]]: ...
def run(text: str, file: str, directory: str, filter: str, jobs: int, quick: bool, quiet: bool) -> bool: ...
