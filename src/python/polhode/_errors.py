"""How wrong a trajectory is: attitude first, then the angular momentum as a vector, then energy."""

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
    """The errors of a trajectory, at each sample and of the whole run.

    Attributes
    ----------
    t : ndarray, shape (n,)
        s.
    series : dict of str to ndarray
        By the names of measures: "attitude" (rad), "omega", "momentum" (the angular momentum as a vector), "energy"
        (relative to their largest), "norm", and what the scene has besides.
    max, final : dict of str to float or None
        The largest over the samples, and at the end of the run.
    bound : float
        How far the truth itself may be off.
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
        def told(value: float | None) -> str:
            return "" if value is None else f"{value:.3g}"

        units = {measure["name"]: measure["unit"] for measure in _MEASURES}
        return [[name, told(self.max[name]), told(self.final[name]), units[name]] for name in self.series]

    def __repr__(self) -> str:
        return "<polhode.Errors, largest: " + ", ".join(f"{row[0]} {row[1]}" for row in self._rows()) + ">"

    def _repr_html_(self) -> str:
        return table_html(["error", "largest", "at the end", "unit"], self._rows(), caption=self.trajectory.method)


def errors(trajectory: Sampled, truth: Truth | None = None, *, digits: int = 25) -> Errors:
    """The errors of a trajectory against the truth of its scene.

    Parameters
    ----------
    trajectory : Trajectory
    truth : Truth, optional
        What it is judged by, at the trajectory's times; found where it is not given.
    digits : int, optional
        Of the truth that is found.

    Returns
    -------
    Errors
        Differences are formed in 128 bits.

    Raises
    ------
    NoTruthError
        Where there is no truth to judge by.

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
