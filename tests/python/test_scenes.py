"""Scenes as dicts and by attributes; errors are reported in one line."""

import copy
import functools
import json
import pickle

import numpy as np
import polhode
import pytest


def test_a_scene_is_a_dict_and_has_attributes():
    top = polhode.scene("lagrange_top")
    assert top["body"]["mass"] == top.body.mass
    top.body.mass = 3
    top["loads"].append({"type": "torque", "vector": np.array([0, 0, 1.0]), "frame": "body"})
    assert top.loads[-1].type == "torque"
    read = json.loads(top.json())
    assert read["body"]["mass"] == 3 and read["loads"][-1]["vector"] == [0, 0, 1]
    del top.duration
    assert "duration" not in top
    with pytest.raises(AttributeError, match="there is no durration"):
        top.durration


def test_every_built_in_scene_reads_back():
    for name, about in polhode.scenes():
        scene = polhode.scene(name)
        assert about and scene.name
        again = polhode.Scene(json.loads(scene.json()), name, scene._directory)
        assert again._compiled().canonical() == scene._compiled().canonical()


def test_a_change_is_seen_by_the_next_solve():
    scene = polhode.scene("free_asymmetric")
    before = polhode.solve(scene, samples=2).q[-1].copy()
    scene.initial.angular_velocity = np.asarray(scene.initial.angular_velocity) * 1.5
    after = polhode.solve(scene, samples=2).q[-1]
    assert not np.array_equal(before, after)


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s["body"].update(mass=2.5),
        lambda s: s.body.pop("center_of_mass"),
        lambda s: s.initial.orientation.__setitem__(0, -1.0),
        lambda s: s.loads.append({"type": "torque", "vector": [0, 0, 1], "frame": "body"}),
        lambda s: s.loads.extend([{"type": "torque", "vector": (0, 0, 1), "frame": "body"}]),
        lambda s: s.loads.pop(),
        lambda s: s.loads.clear(),
        lambda s: s.loads[0].acceleration.reverse(),
        lambda s: s.__ior__({"duration": 3.5}),
        lambda s: s.setdefault("about", "mine") and s.__delitem__("about"),
        lambda s: s.add_torque(lambda now: (0, 0, 1)),
        lambda s: s.loads.__iadd__([{"type": "torque", "vector": np.array([0, 0, 1]), "frame": "body"}]),
        lambda s: s.loads.__delitem__(0),
        lambda s: s.loads[0].__setattr__("acceleration", np.array([0, 0, -3])),
    ],
)
def test_every_way_of_changing_is_noticed(change):
    scene = polhode.scene("lagrange_top")
    scene.initial.orientation = [1.0, 0, 0, 0]
    read = scene._compiled()
    assert scene._compiled() is read
    change(scene)
    assert scene._compiled() is not read


def test_copies_are_their_own():
    scene = polhode.scene("free_asymmetric")
    for other in (scene.copy(duration=1), copy.deepcopy(scene), copy.copy(scene), pickle.loads(pickle.dumps(scene))):
        other.body.mass = 7
        assert scene.body.mass != 7


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"durration": 1}, "/durration"),
        ({"duration": -1}, "/duration"),
        ({"body": {"mass": 1, "inertia": [1, 1, 5]}}, "/body/inertia"),
        ({"duration": float("nan")}, "/duration: is NaN"),
    ],
)
def test_a_fault_is_told_in_one_line(change, words):
    scene = polhode.scene("free_asymmetric").copy(**change)
    with pytest.raises(polhode.InputError, match=words) as fault:
        polhode.solve(scene)
    assert "\n" not in str(fault.value) and ";" in str(fault.value)
    assert isinstance(fault.value, ValueError)


def test_unknown_names_are_told_with_near_misses():
    with pytest.raises(polhode.InputError, match="lagrange_top"):
        polhode.scene("lagrange_topp")
    with pytest.raises(polhode.InputError, match="taylor"):
        polhode.solve("lagrange_top", "taylr")
    with pytest.raises(TypeError, match="a scene contains a set"):
        polhode.solve(polhode.scene("lagrange_top", name={1}))


def test_descriptions(program):
    assert polhode.describe("lagrange_top") == program("describe", "lagrange_top")
    assert polhode.describe("taylor") == program("describe", "taylor")
    assert "Block" not in repr(polhode.scene("t_handle")) and "<table>" in polhode.scene("t_handle")._repr_html_()


def test_methods_are_those_of_the_program(program):
    own = {line.split()[0] for line in program("list", "methods").splitlines()} - {"auto"}
    here = {m.name for m in polhode.methods()}
    assert {name for name in own if not name.startswith("gsl_")} <= here
    assert not any(name.startswith("gsl_") for name in here)
    assert "<table>" in polhode.methods()._repr_html_() and polhode.methods()["taylor"].dense


def test_a_scene_names_files_in_its_own_folder_unless_that_is_allowed(tmp_path):
    box = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
    for face in ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)):
        box += "f " + " ".join(map(str, face)) + "\n"
    (tmp_path / "box.obj").write_text(box)
    (tmp_path / "sub").mkdir()
    for folder, named in ((tmp_path, "box.obj"), (tmp_path / "sub", "../box.obj")):
        (folder / "s.json").write_text(json.dumps(
            {"name": "s", "duration": 1, "body": {"mesh": named, "density": 1}}))
    assert polhode.scene(tmp_path / "s.json").name == "s"
    with pytest.raises(polhode.InputError, match="is outside the folder"):
        polhode.scene(tmp_path / "sub" / "s.json")
    polhode.allow_outside_files(True)
    try:
        assert polhode.scene(tmp_path / "sub" / "s.json").name == "s"
    finally:
        polhode.allow_outside_files(False)


def test_a_torque_on_several_bodies_is_refused_by_the_call():
    pendulum = polhode.scene("mechanisms/double_pendulum")
    with pytest.raises(polhode.InputError, match='type "torque" or "force" with "body", or a "motor"') as fault:
        pendulum.add_torque(lambda now: (0, 0, 1))
    assert "\n" not in str(fault.value) and "/bodies" in str(fault.value)
    # the refused torque was not added
    assert polhode.solve(pendulum, samples=2).status == "ok"
    robot = polhode.Scene({"name": "robot", "duration": 1, "import": {"file": "robot.urdf"}})
    with pytest.raises(polhode.InputError, match="/import"):
        robot.add_torque(lambda now: (0, 0, 1))


def test_an_imported_robot_tells_what_was_omitted_and_what_was_assumed(tmp_path):
    inertial = '<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="{zz}"/>'
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r"><link name="base"/><link name="a"><inertial>{inertial.format(zz=2.001)}</inertial></link>'
        '<joint name="j" type="revolute"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>')
    (tmp_path / "s.json").write_text(
        '{"name": "s", "duration": 1, "import": {"file": "r.urdf", "limits_and_friction": false}}')
    (tmp_path / "t.json").write_text('{"name": "t", "duration": 1, "import": {"file": "r.urdf"}}')
    limited = polhode.scene(tmp_path / "t.json")
    assert limited.omitted == [] and limited.expanded().joints[0].limits == {"lower": -1, "upper": 1, "restitution": 0}
    robot = polhode.scene(tmp_path / "s.json")
    assert any("joint limits" in phrase and "j" in phrase for phrase in robot.omitted)
    assert any("inertia tensors corrected" in phrase and ": a (" in phrase for phrase in robot.assumed)
    assert all(phrase in robot.describe() for phrase in robot.omitted + robot.assumed)
    top = polhode.scene("lagrange_top")
    assert top.omitted == [] and top.assumed == []


def test_a_scene_with_a_torque_that_gets_several_bodies_is_refused_by_every_use():
    calls = []
    scene = polhode.scene("free_asymmetric").add_torque(lambda now: calls.append(now.t) or (0, 0, 1))
    several = json.loads(polhode.scene("mechanisms/double_pendulum").json())
    scene.clear()
    scene.update(several)
    methods = ("auto", "taylor", "dop853", "cvode_adams", "extrapolation", "exact")
    for use in (scene.describe, *(functools.partial(polhode.solve, scene, method) for method in methods)):
        with pytest.raises(polhode.InputError, match="user-defined torque, which scenes with several bodies do not support"):
            use()
    with pytest.raises(polhode.NoTruthError, match="user-defined torque"):
        polhode.truth(scene, samples=2)
    with pytest.raises(polhode.InputError, match="has no truth"):
        polhode.run({"scenes": scene})
    assert not calls


@pytest.mark.parametrize("window", [{"start": 1, "until": 0.5}, {"start": 1, "until": 1}, {"start": float("nan")}])
def test_a_torque_that_never_acts_is_refused(window):
    scene = polhode.scene("free_asymmetric").add_torque(lambda now: (0, 0, 1), **window)
    with pytest.raises(polhode.InputError, match="/loads/0/"):
        polhode.solve(scene)


@pytest.mark.parametrize(
    ("several", "key", "value"),
    [
        (True, "pivot", [0, 0, 0]),
        (True, "planes", [{"normal": [0, 0, 1], "offset": -9, "restitution": 1}]),
        (True, "initial", {"angular_velocity": [1, 0, 0]}),
        (True, "body", {"mass": 1, "inertia": [1, 1, 1]}),
        (True, "loads", [{"type": "torque", "vector": [0, 0, 1], "frame": "body"}]),
        (False, "joints", []),
        (False, "loops", []),
        (False, "bodies", []),
        (False, "loads", [{"type": "motor", "joint": "hinge", "torque": 1}]),
        (False, "loads", [{"type": "torque", "vector": [0, 0, 1], "frame": "body", "body": "arm"}]),
        (False, "loads", [{"type": "point_spring", "first": "a", "second": "b", "stiffness": 1, "rest_length": 1}]),
    ],
)
def test_nothing_of_one_body_is_ignored_beside_several_nor_the_reverse(several, key, value):
    scene = polhode.scene("mechanisms/double_pendulum" if several else "free_asymmetric")
    scene[key] = value
    with pytest.raises(polhode.InputError, match=key):
        polhode.solve(scene)


def test_an_imported_robot_is_expanded() -> None:
    arm = polhode.scene("mechanisms/arm6")
    expanded = arm.expanded()
    assert "import" not in expanded and len(expanded.joints) == 6
    given, other = (polhode.solve(scene, "taylor", samples=4) for scene in (arm, expanded))
    assert (given.q == other.q).all() and (given.p == other.p).all()
    # the copy can be changed
    expanded.joints[0].damping = 0
    assert (polhode.solve(expanded, "taylor", samples=4).q != other.q).any()
