"""Formulas from Python operators, compared with the table of names, Python's arithmetic and built-in loads."""

from __future__ import annotations

import json
import math
import random
import subprocess
from typing import Any

import numpy as np
import pytest
from conftest import PROGRAM

import polhode
from polhode import symbols
from polhode.symbols import clamp, cross, formula, if_, inertia, norm, p, parameter, rotation_error, t, table, v, w


def test_every_name_of_the_language_is_a_symbol() -> None:
    entries = json.loads(subprocess.run([PROGRAM, "list", "formulas", "--format", "json"], check=True,
                                        capture_output=True, text=True).stdout)
    # quantity() makes the quantities of joints
    names = {entry["name"].split("(")[0] for entry in entries if not entry["name"].startswith("JOINT.")}
    known = {name.rstrip("_") for name in symbols.__all__
             if name not in ("Formula", "formula", "parameter", "quantity")}
    assert names == known


@pytest.mark.parametrize("made, text", [
    (-w * 2, "-w*2"), (-(w * 2), "-(w*2)"), (2 - (t - 1), "2 - (t - 1)"), ((2 - t) - 1, "2 - t - 1"),
    (t / (t * 3), "t/(t*3)"), (-t ** 2, "-t^2"), ((-t) ** 2, "(-t)^2"), (t ** 2 ** t, "t^2^t"),
    ((t ** 2) ** 3, "(t^2)^3"), (2 ** -t, "2^(-t)"), ((t + 1) ** 0.5, "(t + 1)^0.5"), (-1.5 * t, "-1.5*t"),
    (t - -2, "t - -2"), (w.x, "w.x"), ((w + p).z, "(w + p).z"), (cross(w, [0, 0, t]).x, "cross(w, [0, 0, t]).x"),
    (if_((t < 1) & ~(t < 0) | (v.x > 2), 1, t), "if(t < 1 and not t < 0 or v.x > 2, 1, t)"),
    (if_((t < 1) & ((t > 0) | (t < -1)), 1, 0), "if(t < 1 and (t > 0 or t < -1), 1, 0)"),
    (if_(t + 1 < 2, 0, 1), "if(t + 1 < 2, 0, 1)"), (np.float64(0.1) * w, "0.1*w"), (1e-300 * t, "1e-300*t"),
    (np.array([1.0, 2, 3]) + w, "[1, 2, 3] + w"), (abs(t), "abs(t)"), (table("thrust", t), "table(thrust, t)"),
    (rotation_error([1, 0, 0, 0]), "rotation_error([1, 0, 0, 0])"),
    (-symbols.quantity("elbow", "rate") * 2, "-elbow.rate*2"), (symbols.quantity("left arm", "p").x, '"left arm".p.x'),
    (symbols.at("arm", [0, 0, 1]) - p, "at(arm, [0, 0, 1]) - p"),
    (symbols.velocity_at("left arm", w), 'velocity_at("left arm", w)')])
def test_the_text_has_the_brackets_that_it_needs(made: Any, text: str) -> None:
    assert str(made) == text


def _random_value(draw: random.Random, x: Any, depth: int) -> Any:
    """A value made by random operators from x: a formula for the symbol t, a number for a number."""
    if depth == 0:
        return x if draw.random() < 0.6 else draw.choice([2, 0.5, -3, 1.25])
    a, b = _random_value(draw, x, depth - 1), _random_value(draw, x, depth - 1)
    kind = draw.randrange(6)
    return (a + b if kind == 0 else a - b if kind == 1 else a * b if kind == 2 else -a if kind == 3
            else a ** 2 if kind == 4 else a / (b ** 2 + 1))


def test_random_formulas_have_the_value_of_the_python_expression() -> None:
    for seed in range(300):
        number = _random_value(random.Random(seed), 0.75, 4)
        text = str(_random_value(random.Random(seed), t, 4))
        # Python groups these operators as the language does
        value = eval(text.replace("^", "**"), {"t": 0.75})
        assert value == number or math.isnan(number), (seed, text)


def test_loads_equal_the_built_in_loads() -> None:
    scene = polhode.scene("free_asymmetric").copy(duration=4, parameters={"c": 0.125}, let={"speed": norm(w)})
    built_in, made = scene.copy(), scene.copy()
    built_in.loads = [polhode.drag(rotational=[0.125, 0.25, 0.5])]
    made.loads = []
    made.loads.append({"type": "torque", "frame": "body",
                       "formula": [-parameter("c") * w.x, -2 * parameter("c") * w.y, -4 * parameter("c") * w.z]})
    reference = polhode.solve(built_in, "taylor", tolerance=1e-14, samples=8)
    motion = polhode.solve(made, "taylor", tolerance=1e-14, samples=8)
    # round-off of two orders of the same terms: some 1e-15 per step, 100 steps
    assert np.abs(motion.q - reference.q).max() < 1e-13
    assert np.abs(motion.w_B - reference.w_B).max() < 1e-13
    # the transport torque cancels w x I w exactly: w stays constant in body axes
    made.loads = [polhode.torque(frame="body", formula=cross(w, inertia(w)))]
    still = polhode.solve(made, "taylor", tolerance=1e-14, samples=8)
    assert np.abs(still.w_B - still.w_B[0]).max() < 1e-13


def test_the_reader_reports_faults_and_python_the_rest() -> None:
    scene = polhode.scene("free_asymmetric").copy(duration=1)
    scene.loads = [polhode.torque(frame="body", formula=2 * parameter("stiffness") * w)]
    with pytest.raises(polhode.InputError, match=r"/loads/0/formula.*column 3.*stiffness"):
        polhode.solve(scene)
    scene.loads = [polhode.torque(frame="body", formula=clamp(t, 0, 1))]
    with pytest.raises(polhode.InputError, match="scalar"):
        polhode.solve(scene)
    with pytest.raises(TypeError, match="truth value"):
        bool(t < 1)
    with pytest.raises(TypeError, match="parameter"):
        formula("k")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="bool"):
        t + True
    with pytest.raises(ValueError, match="finite"):
        t * math.inf
    with pytest.raises(ValueError, match="three components"):
        w + [1, 2]
    with pytest.raises(ValueError, match="four components"):
        rotation_error([1, 0, 0])
    with pytest.raises(ValueError, match="identifier"):
        parameter("left knee")
