"""Rigid bodies, with digits.

polhode computes how a rigid body, or several with joints between them, turns, flies and is pushed about, by every
method worth comparing, and says of each how wrong it is for how much time.

Quantities are in SI units and radians. ``q`` is (w, x, y, z) and maps body vectors to world vectors; ``w`` is the
angular velocity in world axes and ``w_B`` the same in the body's; ``p`` and ``v`` are of the centre of mass.

Examples
--------
>>> import polhode
>>> top = polhode.scene("lagrange_top")
>>> motion = polhode.solve(top, "cvode_adams", tolerance=1e-10)
>>> motion.status, motion.q.shape
('ok', (101, 4))
>>> motion.errors().max["attitude"] < 1e-6
True
"""

from polhode._checking import Report, check
from polhode._ensembles import Ensemble, ensemble
from polhode._errors import Errors, errors
from polhode._experiments import Results, run
from polhode._methods import Method, method, methods, solver
from polhode._polhode import InputError, LoadState, NoTruthError, RightHandSide, __version__, allow_outside_files
from polhode._scenes import Scene, describe, scene, scenes
from polhode._solving import Motion, OdeResult, Trajectory, solve, solve_ivp, trajectory
from polhode._truth import Truth, truth

__all__ = [
    "Ensemble",
    "Errors",
    "InputError",
    "LoadState",
    "Method",
    "Motion",
    "NoTruthError",
    "OdeResult",
    "Report",
    "Results",
    "RightHandSide",
    "Scene",
    "Trajectory",
    "Truth",
    "__version__",
    "allow_outside_files",
    "check",
    "describe",
    "ensemble",
    "errors",
    "method",
    "methods",
    "run",
    "scene",
    "scenes",
    "solve",
    "solve_ivp",
    "solver",
    "trajectory",
    "truth",
]
