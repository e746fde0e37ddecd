"""Simulation of rigid bodies and mechanisms with measured errors.

polhode simulates rigid bodies and mechanisms with more than a hundred integrators and reports each one's error,
against a reference solution (the truth) with proven digits, next to its run time.

Quantities are in SI units and radians. ``q`` is (w, x, y, z) and maps body vectors to world vectors. ``w`` is the
angular velocity in world axes, ``w_B`` in body axes. ``p`` and ``v`` are position and velocity of the centre of mass.

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
