"""Judging a trajectory of anyone's making."""

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
    """What ``polhode check`` found.

    Attributes
    ----------
    ok : bool
        Whether every error is within its limit.
    text : str
        The report as the program prints it: errors, known faults that explain them, floors.
    data : dict
        The same for machines.
    explanation : str
        The faults that were tried and what each leaves, where that was asked for.
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
    """Judges trajectories against the truth, each block that they have against its limit, and says what ails them.

    Parameters
    ----------
    trajectory : Trajectory, path, mapping of columns, or a list of them
        Columns are named as in trajectory files: t, qw, qx, qy, qz, and where they are known wx.., px.., vx..
    scene : scene, str, path or mapping, optional
        What they are trajectories of; a Trajectory knows its own.
    limits : mapping, optional
        By block ("attitude", "angular_velocity", "position", "velocity", "energy", "momentum"): a number in SI, or a
        part of the motion's size such as "2%". Default: what the scene tolerates, else what a game could live with.
    convention : str, optional
        What they are written in, words joined by commas: ``y-up``, ``left-handed``, ``degrees``, ``body-rates``,
        ``scalar-last``, ``unity``, ``unreal``, .. as ``polhode check --help`` lists them.
    explain : bool, optional
        List the faults that were tried, of sound trajectories too.

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
