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

from typing import TYPE_CHECKING

from polhode import symbols
from polhode._attitudes import BodyMotion
from polhode._builders import BUILDERS, Builder
from polhode._checking import Report, check
from polhode._contacts import ContactEvent, ContactInterval
from polhode._ensembles import Ensemble, ensemble
from polhode._errors import Errors, errors
from polhode._events import Event
from polhode._experiments import Results, run
from polhode._joints import JointMotion, Joints, Reactions
from polhode._lessons import lesson_page
from polhode._methods import Method, method, methods, solver
from polhode._polhode import InputError, LoadState, NoTruthError, RightHandSide, __version__, allow_outside_files
from polhode._scenes import Scene, describe, scene, scenes
from polhode._sensitivity import Derivative, Fit, Sensitivity, fit, sensitivity
from polhode._solving import Motion, OdeResult, Trajectory, solve, solve_ivp, trajectory
from polhode._truth import Truth, truth

__all__ = [
    "BodyMotion",
    "ContactEvent",
    "ContactInterval",
    "Derivative",
    "Ensemble",
    "Errors",
    "Event",
    "Fit",
    "InputError",
    "JointMotion",
    "Joints",
    "LoadState",
    "Method",
    "Motion",
    "NoTruthError",
    "OdeResult",
    "Reactions",
    "Report",
    "Results",
    "RightHandSide",
    "Scene",
    "Sensitivity",
    "Trajectory",
    "Truth",
    "__version__",
    "allow_outside_files",
    "check",
    "describe",
    "ensemble",
    "errors",
    "fit",
    "lesson_page",
    "method",
    "methods",
    "run",
    "scene",
    "scenes",
    "sensitivity",
    "solve",
    "solve_ivp",
    "solver",
    "symbols",
    "trajectory",
    "truth",
]

# functions that build the objects of a scene; a type without a declaration below has a function, too
globals().update({name: builder for name, builder in BUILDERS.items() if name not in globals()})
__all__ += sorted(BUILDERS)

if TYPE_CHECKING:
    body: Builder
    named_body: Builder
    initial: Builder
    part: Builder
    plane: Builder
    gravity: Builder
    torque: Builder
    force: Builder
    impulse: Builder
    drag: Builder
    spring: Builder
    motor: Builder
    point_spring: Builder
    revolute: Builder
    compound: Builder
    cylindrical: Builder
    screw: Builder
    planar: Builder
    free: Builder
    prismatic: Builder
    spherical: Builder
    universal: Builder
    fixed: Builder
    loop_spherical: Builder
    loop_revolute: Builder
    loop_distance: Builder
    box: Builder
    sphere: Builder
    hollow_sphere: Builder
    cylinder: Builder
    hollow_cylinder: Builder
    capsule: Builder
    cone: Builder
    ellipsoid: Builder
    torus: Builder
    rod: Builder
    disc: Builder
    plate: Builder
    tetrahedron: Builder
    frustum: Builder
