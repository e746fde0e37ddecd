"""Events and modes of contacts and joints, against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest

BALL: dict[str, Any] = {
    "name": "bowling", "duration": 3,
    "body": {"mass": 2, "shape": {"type": "sphere", "radius": 0.1}},
    "initial": {"position": [0, 0, 0.1], "velocity": [2, 0, 0]},
    "planes": [{"name": "lane", "normal": [0, 0, 1], "restitution": 0, "friction": 0.2}],
    "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}],
}
ROLLS = 2 * 2 / (7 * 0.2 * 9.8)  # the slip ends at 2 |u| / (7 mu g)


def test_modes_and_events_of_a_method() -> None:
    motion = polhode.solve(BALL, "taylor", samples=3)
    assert [(one.mode, one.other) for one in motion.modes] == [("sliding", "lane"), ("rolling", "lane")]
    assert motion.modes[0].end == pytest.approx(ROLLS, rel=1e-14)
    assert motion.modes[0].largest_ratio == pytest.approx(1)
    rolls = [event for event in motion.contact_events if event.event == "rolls"]
    assert [event.t for event in rolls] == [motion.modes[1].begin]


def test_modes_and_events_of_a_truth() -> None:
    truth = polhode.truth(BALL, samples=1, digits=25)
    assert [one.mode for one in truth.modes] == ["sliding", "rolling"]
    (rolls,) = [event for event in truth.contact_events if event.event == "rolls"]
    assert rolls.t == pytest.approx(ROLLS, rel=1e-15)
    assert rolls.other == "lane" and len(rolls.decimal_t) > 20
    assert (rolls.normal_impulse, list(rolls.tangential_impulse)) == (0, [0, 0, 0])


def test_an_impact_has_an_impulse() -> None:
    scene = {**BALL, "duration": 0.6, "initial": {"position": [0, 0, 1.1]}}
    scene["planes"] = [{"normal": [0, 0, 1], "restitution": 0.5, "friction": 0.2}]
    impact = polhode.solve(scene, "taylor", samples=1).contact_events[0]
    assert impact.event == "impact"
    assert impact.t == pytest.approx(np.sqrt(2 / 9.8), rel=1e-14)
    assert impact.normal_impulse == pytest.approx(2 * 1.5 * np.sqrt(2 * 9.8), rel=1e-13)


def test_events_of_a_joint() -> None:
    scene = {
        "name": "block", "duration": 3,
        "bodies": [{"name": "block", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
        "joints": [{"name": "rail", "type": "prismatic", "parent": "world", "child": "block", "axis": [1, 0, 0],
                    "friction": 4, "initial": {"speed": 3}}],
    }
    motion = polhode.solve(scene, "taylor", samples=3)
    assert [(event.other, event.event) for event in motion.contact_events] == [("rail", "sticks")]
    assert motion.contact_events[0].t == pytest.approx(1.5, rel=1e-14)
    truth = polhode.truth(scene, samples=3)
    assert [event.event for event in truth.contact_events] == ["sticks"]


def test_without_contacts_there_are_no_events() -> None:
    with pytest.raises(polhode.InputError, match="the scene has no planes or contacts, and no joint"):
        polhode.solve("free_asymmetric", "taylor", samples=1).contact_events  # noqa: B018
    assert polhode.truth("free_asymmetric", samples=1).contact_events == []
