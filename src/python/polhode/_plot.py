"""Figures in the colours of the project. matplotlib is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from polhode import _polhode
from polhode._types import Sampled, SeriesOfErrors

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pandas import DataFrame


class MethodStyle(Protocol):
    """Color and marker of a method."""

    @property
    def color(self) -> str: ...
    @property
    def mark(self) -> str: ...


#: Colours of curves that are not methods, in the order of the program's figures. They remain distinguishable with
#: red-green colour blindness.
COLORS = tuple(_polhode.plain_colors())

#: matplotlib's markers by the names of `Method.mark`. Open markers have the fill style none.
_MARKS = {"circle": "o", "square": "s", "triangle-up": "^", "diamond": "D", "triangle-down": "v", "pentagon": "p",
          "cross-thin": "+", "x-thin": "x", "asterisk": (6, 2, 0)}

#: Axis labels for columns of tables.
_HEADINGS = {
    "seconds_median": "time (s)",
    "seconds_min": "shortest time (s)",
    "rhs_evaluations": "evaluations of the right-hand side",
    "steps": "steps",
    "setting": "step (s) or tolerance",
    "attitude_error_max": "largest attitude error (rad)",
    "attitude_error_final": "attitude error at the end (rad)",
    "momentum_error_max": "largest error of the angular momentum, relative",
    "energy_error_max": "largest error of the energy, relative",
    "omega_error_max": "largest error of the angular velocity, relative",
}

#: Lower end of the error axis. Errors below it stem from rounding the start; they are computed beyond double precision.
_SMALLEST_SHOWN = 1e-18


def _frames(count: int, options: dict[str, Any]) -> tuple[Figure, list[Axes]]:
    import matplotlib.pyplot as plt

    columns = min(count, 2)
    rows = -(-count // columns)
    options.setdefault("figsize", (6.4 * columns, 4.2 * rows))
    figure, axes = plt.subplots(rows, columns, squeeze=False, layout="constrained", **options)
    frames = list(axes.flat)
    for spare in frames[count:]:
        spare.set_visible(False)
    for frame in frames[:count]:
        frame.grid(True, color="#dddddd", linewidth=0.6)
        for side in ("top", "right"):
            frame.spines[side].set_visible(False)
    return figure, frames[:count]


def plot_trajectory(trajectory: Sampled, **options: Any) -> Figure:
    """Draws attitude, angular velocity and, if it moves, the centre of mass over time."""
    several = trajectory.q.ndim == 3
    blocks = [("q", "attitude q", "wxyz"), ("w_B", "angular velocity, body axes (rad/s)", "xyz")]
    if np.ptp(trajectory.p.reshape(-1, 3), axis=0).max(initial=0.0) > 0:
        blocks.append(("p", "centre of mass (m)", "xyz"))
    figure, frames = _frames(len(blocks), options)
    for frame, (name, heading, components) in zip(frames, blocks):
        values = getattr(trajectory, name)
        names = trajectory.scene.body_names if several else [""]
        for body, called in enumerate(names):
            for i, component in enumerate(components):
                curve = values[:, body, i] if several else values[:, i]
                frame.plot(trajectory.t, curve, color=COLORS[(3 * body + i) % len(COLORS)],
                           linestyle=("-", "--", ":", "-.")[body % 4],
                           label=f"{called} {component}".strip())
        frame.set_xlabel("t (s)")
        frame.set_ylabel(heading)
        # above the frame, so that it does not cover curves
        frame.legend(frameon=False, fontsize="small", ncols=len(components), loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.suptitle(f"{trajectory.scene.get('name', '')}, {trajectory.method}", fontsize="medium")
    return figure


def plot_errors(errors: SeriesOfErrors, **options: Any) -> Figure:
    """Draws errors over time."""
    options.setdefault("figsize", (8.0, 4.6))
    figure, (frame,) = _frames(1, options)
    largest = 0.0
    for i, (name, series) in enumerate(errors.series.items()):
        shown = np.where(series > 0, series, np.nan)
        if not np.isnan(shown).all():
            frame.semilogy(errors.t, shown, color=COLORS[i % len(COLORS)], label=name)
            largest = max(largest, float(np.nanmax(shown)))
    if largest > _SMALLEST_SHOWN and frame.get_ylim()[0] < _SMALLEST_SHOWN:
        frame.set_ylim(bottom=_SMALLEST_SHOWN)
    frame.set_xlabel("t (s)")
    frame.set_ylabel("error (rad, m or relative)")
    frame.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    frame.set_title(f"{errors.trajectory.scene.get('name', '')}, {errors.trajectory.method}", fontsize="medium")
    return figure


def plot_table(table: DataFrame, x: str, y: str, known: Mapping[str, MethodStyle], **options: Any) -> Figure:
    """Draws one curve per method and kind of setting, in one frame per scene. `known` has the styles of methods."""
    scenes = list(dict.fromkeys(table["scene"]))
    options.setdefault("figsize", (8.6, 5.0) if len(scenes) == 1 else (13.0, 4.4 * -(-len(scenes) // 2)))
    figure, frames = _frames(len(scenes), options)
    curves = list(dict.fromkeys(zip(table["method"], table["setting_kind"])))
    both = {method for method, _ in curves if sum(one == method for one, _ in curves) > 1}
    entries: dict[str, Any] = {}
    for frame, scene in zip(frames, scenes):
        for i, (method, kind) in enumerate(curves):
            rows = table[(table["scene"] == scene) & (table["method"] == method) & (table["setting_kind"] == kind)]
            ended = rows[rows["status"].isin(["ok", "tolerance_not_met"])].dropna(subset=[x, y])
            ended = ended[(ended[x] > 0) & (ended[y] > 0)]
            if ended.empty:
                continue
            label = f"{method} ({kind})" if method in both else method
            style = known.get(method)
            mark = style.mark if style else "circle"
            entries[label] = frame.loglog(
                ended[x], ended[y], color=style.color if style else COLORS[i % len(COLORS)], label=label,
                markersize=4.5, marker=_MARKS[mark.removesuffix("-open")], linewidth=1.3,
                fillstyle="none" if mark.endswith("-open") else "full",
                linestyle="--" if method in both and kind == "step" else "-")[0]
        if "float64_floor" in table and y.startswith("attitude"):
            floor = table.loc[table["scene"] == scene, "float64_floor"].max()
            if floor > 0:
                entries["float64 floor"] = frame.axhline(floor, color="#5a5a5a", linewidth=0.8, linestyle="--")
        frame.set_title(scene, fontsize="medium")
        frame.set_xlabel(_HEADINGS.get(x, x))
        frame.set_ylabel(_HEADINGS.get(y, y))
    beside = frames[1 if len(frames) > 1 else 0]
    beside.legend(entries.values(), entries.keys(), loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False,
                  fontsize="small")
    return figure
