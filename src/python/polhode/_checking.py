"""Comparison of trajectories from any program with the truth."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Union

import numpy as np

from polhode import _polhode
from polhode._scenes import SceneLike, scene as make_scene
from polhode._types import Solved

#: A trajectory, a file's path, or columns by the names of trajectory files (a dict of arrays, a pandas DataFrame).
TrajectoryLike = Union[Solved, str, "os.PathLike[str]", Mapping[str, Any]]


class Report:
    """Result of `check`, as ``polhode check`` reports it.

    Attributes
    ----------
    ok : bool
        Whether every error is within its limit.
    text : str
        The report as the program prints it: errors, diagnosed faults, floors.
    data : dict
        The report as ``polhode check --format json`` prints it.
    explanation : str
        The faults that were tried and the error that each leaves; empty without ``explain``.
    """

    def __init__(self, ok: bool, text: str, data: dict[str, Any], explanation: str) -> None:
        self.ok = ok
        self.text = text
        self.data = data
        self.explanation = explanation

    def __bool__(self) -> bool:
        return self.ok

    def __repr__(self) -> str:
        return self.text + self.explanation

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(repr(self))}</pre>"


def _named_text(given: TrajectoryLike, number: int) -> tuple[str, str]:
    if isinstance(given, Solved):
        return f"trajectory {number} ({given.method})", given.csv()
    if isinstance(given, (str, os.PathLike)):
        path = os.fspath(given)
        try:
            return path, Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as fault:
            raise _polhode.InputError(f"{path}: cannot be read ({fault}); give a readable CSV file") from None
    columns = {str(name): given[name] for name in given}  # a DataFrame is like a mapping
    lines = [",".join(columns)]
    rows = zip(*(np.asarray(column).tolist() for column in columns.values()))
    lines += [",".join(str(value) for value in row) for row in rows]
    return f"table {number}", "\n".join(lines) + "\n"


def check(
    trajectory: TrajectoryLike | list[TrajectoryLike],
    scene: SceneLike | None = None,
    *,
    limits: Mapping[str, float | str] | None = None,
    convention: str = "",
    explain: bool = False,
) -> Report:
    """Compares trajectories with the truth, each block with its limit, and diagnoses known faults.

    Parameters
    ----------
    trajectory : Trajectory, path, mapping of columns, or a list of them
        Columns are named as in trajectory files. Required: t, qw, qx, qy, qz. Optional: wx.., px.., vx..
    scene : scene, str, path or mapping, optional
        The scene of the trajectories. Default: the scene of the Trajectory.
    limits : mapping, optional
        Largest allowed error by block ("attitude", "angular_velocity", "position", "velocity", "energy", "momentum"):
        a number in SI, or relative to the motion's size such as "2%". Default: the scene's ``tolerated``, otherwise
        the defaults of ``polhode check``.
    convention : str, optional
        Convention of the data, words joined by commas: ``y-up``, ``left-handed``, ``degrees``, ``body-rates``,
        ``scalar-last``, ``unity``, ``unreal``, .. ``polhode check --help`` lists all words.
    explain : bool, optional
        List the faults that were tried, also for trajectories within their limits.

    Returns
    -------
    Report

    Examples
    --------
    >>> import polhode
    >>> wrong = polhode.solve("t_handle", "article_as_written", step=0.01)
    >>> bool(polhode.check(wrong))
    False
    >>> "gyroscopic" in polhode.check(wrong).text
    True
    """
    all_given = trajectory if isinstance(trajectory, list) else [trajectory]
    if scene is None:
        first = all_given[0]
        if not isinstance(first, Solved):
            raise _polhode.InputError("no scene; give the scene of the trajectory: check(trajectory, scene)")
        scene = first.scene
    texts = [_named_text(one, i + 1) for i, one in enumerate(all_given)]
    said = {block: str(limit) for block, limit in (limits or {}).items()}
    ok, text, data, explanation = _polhode.check(make_scene(scene)._compiled(), texts, convention, said, explain)
    return Report(ok, text, json.loads(data), explanation)
