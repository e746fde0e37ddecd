"""Functions that build scenes, compared with scene files and with the table of keys of the program."""

from __future__ import annotations

import inspect

import pytest

import polhode
from polhode import _polhode


def test_a_scene_from_builders_is_that_of_the_file() -> None:
    built = polhode.scene(
        name="mechanisms/double_pendulum", duration=5,
        bodies=[polhode.named_body(name, polhode.body(shape=polhode.box([0.03125, 0.0625, 0.5]), mass=1))
                for name in ("upper", "lower")],
        joints=[polhode.revolute("shoulder", "world", "upper", [0, 1, 0], child_point=[0, 0, 0.5], angle=2),
                polhode.revolute("elbow", "upper", "lower", [0, 1, 0], parent_point=[0, 0, -0.5],
                                 child_point=[0, 0, 0.5], angle=0.5)],
        loads=[polhode.gravity([0, 0, -9.81])])
    file = polhode.scene("mechanisms/double_pendulum")
    for key in ("duration", "bodies", "joints", "loads"):
        assert built[key] == file[key], key
    assert (polhode.solve(built, samples=5).q == polhode.solve(file, samples=5).q).all()


def test_every_type_of_the_table_has_a_builder() -> None:
    known = {row[0] for row in _polhode.scene_keys()}
    for name in known:
        for prefix, before in (("load ", ""), ("joint ", ""), ("loop ", "loop_"), ("shape ", "")):
            if name.startswith(prefix):
                builder = getattr(polhode, before + name[len(prefix):])
                text = inspect.getdoc(builder) or ""
                for row in _polhode.scene_keys():
                    if row[0] == name and row[1] not in ("type", "initial"):
                        assert f"\n{row[1]}" in text and row[4] in text + "required none", (name, row[1])
    assert "angle" in inspect.signature(polhode.revolute).parameters
    assert list(inspect.signature(polhode.gravity).parameters) == ["acceleration", "from_", "until"]


def test_arguments_become_keys() -> None:
    assert polhode.gravity([0, 0, -9.81], from_=1) == {"type": "gravity", "acceleration": [0, 0, -9.81], "from": 1}
    assert polhode.spherical("s", "world", "b", orientation=[1, 0, 0, 0], stiffness=0) == {
        "type": "spherical", "name": "s", "parent": "world", "child": "b",
        "initial": {"orientation": [1, 0, 0, 0]}, "stiffness": 0}
    assert polhode.body(mass=2, inertia=[1, 1, 1], center_of_mass=None) == {"mass": 2, "inertia": [1, 1, 1]}
    assert polhode.loop_distance("l", "a", "b", 0.5)["type"] == "distance"
    with pytest.raises(TypeError, match="masss"):
        polhode.body(masss=1)
    with pytest.raises(TypeError, match="acceleration"):
        polhode.gravity()


def test_errors_point_at_the_expression() -> None:
    scene = polhode.scene(duration=1, body=polhode.body(mass=1, inertia=[1, 1, 3]))
    with pytest.raises(polhode.InputError, match=r"/body/inertia.* \(in Python: scene\.body\.inertia.*body\(\.\., inertia=\.\.\)\)"):
        polhode.solve(scene)
    pendulum = polhode.scene(
        duration=1, bodies=[polhode.named_body("bar", polhode.body(shape=polhode.rod(1), mass=2))],
        joints=[polhode.revolute("hinge", "world", "bar", [0, 1, 0], angle="up")])
    with pytest.raises(polhode.InputError) as caught:
        polhode.solve(pendulum)
    assert "the scene: /joints/0/initial/angle: " in str(caught.value)
    assert str(caught.value).endswith(" (in Python: scene.joints[0].initial.angle, revolute(.., angle=..))")
    # a copy, and a scene that was changed, keep the place
    changed = pendulum.copy(duration=2)
    with pytest.raises(polhode.InputError, match=r"revolute\(\.\., angle=\.\.\)"):
        polhode.solve(changed)
    top = polhode.scene("lagrange_top")
    top.body.mass = -1
    with pytest.raises(polhode.InputError, match=r"/body/mass: .* \(in Python: scene\.body\.mass\)"):
        polhode.solve(top)
