"""Errors of a trajectory against the truth: attitude first, then angular momentum as a vector, then energy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from polhode import _polhode
from polhode._html import table_html
from polhode._plot import plot_errors
from polhode._truth import Truth
from polhode._types import Array, Sampled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MEASURES: list[dict[str, str]] = _polhode.measures()


class Errors:
    """The errors of a trajectory at each sample and over the run.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times of the samples, s.
    series : dict of str to ndarray
        Errors by measure: "attitude" (rad), "omega", "momentum" (the angular momentum as a vector) and "energy"
        (relative to their largest values), "norm", and further measures that apply to the scene.
    max, final : dict of str to float or None
        Largest error over the samples, and error at the end of the run.
    bound : float
        Error bound of the truth.
    """

    def __init__(self, trajectory: Sampled, found: dict[str, Any]) -> None:
        self.trajectory = trajectory
        self.t: Array = found["t"]
        self.series: dict[str, Array] = found["series"]
        self.max: dict[str, float | None] = found["max"]
        self.final: dict[str, float | None] = found["final"]
        self.bound: float = found["bound"]
        self.truth: str = found["truth"]
        self.worst_body: str = found["worst_body"]

    def __getattr__(self, name: str) -> Array:
        series = self.__dict__.get("series", {})
        if name in series:
            return series[name]  # type: ignore[no-any-return]
        raise AttributeError(f"there is no error {name}; the errors are {', '.join(series)}")

    def plot(self, **options: Any) -> Figure:
        """Draws the errors over time, on a logarithmic axis.

        Returns
        -------
        matplotlib.figure.Figure
        """
        return plot_errors(self, **options)

    def _rows(self) -> list[list[str]]:
        def format_error(value: float | None) -> str:
            return "" if value is None else f"{value:.3g}"

        units = {measure["name"]: measure["unit"] for measure in _MEASURES}
        return [[name, format_error(self.max[name]), format_error(self.final[name]), units[name]] for name in self.series]

    def __repr__(self) -> str:
        return "<polhode.Errors, largest: " + ", ".join(f"{row[0]} {row[1]}" for row in self._rows()) + ">"

    def _repr_html_(self) -> str:
        return table_html(["error", "largest", "at the end", "unit"], self._rows(), caption=self.trajectory.method)


def errors(trajectory: Sampled, truth: Truth | None = None, *, digits: int = 25) -> Errors:
    """Computes the errors of a trajectory against the truth of its scene.

    Parameters
    ----------
    trajectory : Trajectory
        The trajectory to compare.
    truth : Truth, optional
        A truth at the trajectory's times. The errors are then computed with at least its digits.
    digits : int, optional
        Digits of the truth that the errors are computed with.

    Returns
    -------
    Errors
        Differences are computed with 128 bits.

    Raises
    ------
    NoTruthError
        If the truth is not available.

    Examples
    --------
    >>> import polhode
    >>> off = polhode.errors(polhode.solve("free_asymmetric", "odeint_rk4", step=0.01))
    >>> off.max["attitude"] < 1e-5, off.attitude.shape
    (True, (101,))
    """
    if truth is not None:
        if list(truth.t) != list(trajectory.t):
            raise _polhode.InputError("truth and trajectory have different times; give truth(scene, trajectory.t)")
        digits = max(digits, 25 if truth.certified else truth.digits)
    return Errors(trajectory, _polhode.errors(trajectory._native, min(digits, 80), 3600.0))
