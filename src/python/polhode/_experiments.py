"""Experiments: sweeps of scenes, methods and settings, with tables and figures."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from polhode import _polhode
from polhode._methods import methods
from polhode._plot import plot_table
from polhode._scenes import Scene, _plain, scene as make_scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

#: The name of an experiment, its file, or the contents of one.
ExperimentLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Results:
    """Results of an experiment.

    Attributes
    ----------
    name : str
        Name of the experiment.
    directory : pathlib.Path
        Directory of its files: tables as CSV, Markdown, LaTeX and JSON, figures, provenance.
    """

    def __init__(self, name: str, directory: Path) -> None:
        self.name = name
        self.directory = directory

    @cached_property
    def tables(self) -> dict[str, DataFrame]:
        """All tables by name. The table named like the experiment has one row per run."""
        import pandas as pd

        return {path.stem: pd.read_csv(path) for path in sorted(self.directory.glob(f"{self.name}*.csv"))}

    @property
    def table(self) -> DataFrame:
        """One row per run: status, seconds, counts and errors, in the columns of the result table."""
        return self.tables[self.name] if self.name in self.tables else next(iter(self.tables.values()))

    @property
    def pictures(self) -> list[Path]:
        """The figures of the experiment (SVG and PDF). They require gnuplot."""
        return [path for ending in ("svg", "pdf") for path in sorted(self.directory.glob(f"{self.name}*.{ending}"))]

    def plot(self, x: str = "seconds_median", y: str = "attitude_error_max", **options: Any) -> Figure:
        """Draws one curve per method in one frame per scene; by default a work-precision diagram.

        Parameters
        ----------
        x, y : str, optional
            Columns of the table: ``x="rhs_evaluations"`` for work that does not depend on the machine,
            ``x="setting"`` for convergence.
        **options
            Arguments of ``matplotlib.pyplot.figure``.

        Returns
        -------
        matplotlib.figure.Figure
        """
        for name in (x, y):
            if name not in self.table:
                raise _polhode.InputError(f"there is no column {name}; the columns are {', '.join(self.table)}")
        return plot_table(self.table, x, y, {one.name: one for one in methods()}, **options)

    def __repr__(self) -> str:
        return f"<polhode.Results of {self.name}: {len(self.table)} rows, in {self.directory}>"

    def _repr_html_(self) -> str:
        shown = ["scene", "method", "setting", "status", "seconds_median", "rhs_evaluations", "attitude_error_max",
                 "momentum_error_max", "energy_error_max", "message"]
        table = self.table
        return str(table[[name for name in shown if name in table]].to_html(index=False, na_rep="", max_rows=60))


def _scene_files(scenes: Iterable[Any], folder: Path) -> list[str]:
    names = []
    for number, one in enumerate(scenes):
        if isinstance(one, (str, os.PathLike)):
            names.append(os.fspath(one))
            continue
        posed = make_scene(one)
        if posed._torques:
            raise _polhode.InputError(
                f"{posed.name}: a scene with a user-defined torque has no truth, which experiments require; remove it")
        path = folder / f"scene_{number}.json"
        path.write_text(_polhode.ReadScene(posed.json(), posed._file, posed._directory, []).canonical(), "utf-8")
        names.append(str(path))
    return names


def run(
    experiment: ExperimentLike,
    output: str | os.PathLike[str] | None = None,
    *,
    filter: str = "",
    quick: bool = False,
    jobs: int = 0,
    quiet: bool = True,
) -> Results:
    """Runs an experiment. With the same output directory, an interrupted run is continued.

    Parameters
    ----------
    experiment : str, path or mapping
        A built-in experiment, a file, or the contents of one: ``scenes`` (also `Scene` and dicts), ``methods`` (also
        functions made by `method` and `solver`), ``settings``, .. A mapping without name, about or settings gets
        defaults: tolerances from 1e-3 to 1e-13, steps from T/100 to T/1e5 for the duration T of the first scene.
    output : path, optional
        Directory for tables, figures and finished cases. Default: a new temporary directory.
    filter : str, optional
        Run only cases whose SCENE/METHOD matches this regular expression.
    quick : bool, optional
        Use every third setting and short runs.
    jobs : int, optional
        Threads for truths and errors; 0: all cores. Timed runs run one at a time.
    quiet : bool, optional
        Do not print progress to standard error.

    Returns
    -------
    Results
        Tables and figures of the experiment.

    Examples
    --------
    >>> import polhode
    >>> found = polhode.run({"scenes": ["free_asymmetric"], "methods": ["dop853", "odeint_rk4"], "repeats": 1,
    ...                      "settings": {"tolerances": [1e-6, 1e-9], "steps": [0.02]}})
    >>> sorted(set(found.table["status"])), len(found.table)
    (['ok'], 3)
    """
    directory = Path(tempfile.mkdtemp(prefix="polhode-") if output is None else output)
    directory.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="polhode-scenes-") as folder:
        if isinstance(experiment, Mapping):
            data: dict[str, Any] = {"name": "own", "about": "A user-defined experiment", **experiment}
            given = data.get("scenes", [])
            scenes = [given] if isinstance(given, (str, os.PathLike, Mapping)) else list(given)
            data["scenes"] = _scene_files(scenes, Path(folder))
            asked = data.get("methods", [])
            data["methods"] = [getattr(one, "__polhode_method__", one)
                               for one in ([asked] if isinstance(asked, str) or callable(asked) else asked)]
            if "settings" not in data and "kind" not in data and scenes:
                duration = float(make_scene(scenes[0]).get("duration", 1))
                data["settings"] = {
                    "tolerances": {"from": 1e-3, "to": 1e-13, "count": 11},
                    "steps": {"from": duration / 100, "to": duration / 1e5, "count": 10},
                }
            text, file = json.dumps(data, default=_plain), "the experiment"
        else:
            file = os.fspath(experiment)
            text = _polhode.experiment_text(file)
        name = str(json.loads(text).get("name", ""))
        if not _polhode.run(text, file, str(directory), filter, jobs, quick, quiet,
                            isinstance(experiment, Mapping)):
            raise KeyboardInterrupt
    return Results(name, directory)


__all__ = ["Results", "Scene", "run"]
