"""An independent reader of URDF: converts links and joints to MJCF for MuJoCo.

MuJoCo also reads URDF, and `compute` compares both readings. This reader is the only reference for files that MuJoCo
refuses: links whose tensor is possible only after fixed joints have merged them, tensors that rounding made impossible,
and links without mass between two hinges.

It applies these steps in this order. Links fixed to a moving link are merged into it and become frames; links fixed to
the world are dropped. A link without mass passes its joint to its only child; at the end of the tree it is dropped. If
the largest moment of a tensor exceeds the sum of the others by e, it is reduced by e/3 and the others are increased by
e/3, which is the smallest change of the three moments.
"""
import xml.etree.ElementTree as ElementTree

import numpy as np

from sdf_to_mjcf import combine, mjcf_vector, numbers, placed, principal, quaternion, rotation_rpy


def origin_of(at):
    given = at.find("origin")
    if given is None:
        return np.eye(4)
    return placed(rotation_rpy(*numbers(given.get("rpy", "0 0 0"))), numbers(given.get("xyz", "0 0 0")))


def link_mass(link):
    inertial = link.find("inertial")
    if inertial is None or float(inertial.find("mass").get("value")) == 0:
        return None
    given = inertial.find("inertia")
    tensor = np.array([[float(given.get("i" + "".join(sorted(a + b)), 0)) for b in "xyz"] for a in "xyz"])
    X = origin_of(inertial)
    return float(inertial.find("mass").get("value")), X[:3, 3], X[:3, :3] @ tensor @ X[:3, :3].T


def repaired(moments):
    """Ascending moments that satisfy the triangle inequality, by the smallest change."""
    excess = moments[2] - moments[0] - moments[1]
    return moments + excess / 3 * np.array([1, 1, -1]) if excess > 0 else moments


class Element:
    """A joint element of MJCF in its child's frame, which may still change."""

    def __init__(self, joint):
        self.name, self.type = joint.get("name"), joint.get("type")
        given, dynamics = joint.find("axis"), joint.find("dynamics")
        self.axis = np.array(numbers(given.get("xyz")) if given is not None else [1.0, 0, 0])
        self.point = np.zeros(3)
        self.damping = float(dynamics.get("damping", 0)) if dynamics is not None else 0.0

    def move(self, X):
        self.axis, self.point = X[:3, :3] @ self.axis, X[:3, :3] @ self.point + X[:3, 3]

    def text(self):
        if self.type == "floating":
            return f'<joint name="{self.name}" type="free" damping="{self.damping!r}"/>'
        if self.type == "planar":
            # two directions perpendicular to the axis, and the axis
            first = np.cross(self.axis, np.eye(3)[np.argmin(np.abs(self.axis))])
            return "".join(f'<joint name="{self.name}_{key}" type="{kind}" pos="{mjcf_vector(self.point)}" '
                           f'axis="{mjcf_vector(v)}"/>'
                           for key, kind, v in (("x", "slide", first), ("y", "slide", np.cross(self.axis, first)),
                                                ("turn", "hinge", self.axis)))
        kind = "slide" if self.type == "prismatic" else "hinge"
        return (f'<joint name="{self.name}" type="{kind}" pos="{mjcf_vector(self.point)}" '
                f'axis="{mjcf_vector(self.axis)}" damping="{self.damping!r}"/>')


def convert_to_mjcf(path, free_base=False):
    root = ElementTree.parse(path).getroot()
    masses = {link.get("name"): link_mass(link) for link in root.findall("link")}
    joints = root.findall("joint")
    below = {}
    for joint in joints:
        below.setdefault(joint.find("parent").get("link"), []).append(joint)
    carried = {joint.find("child").get("link") for joint in joints}
    roots = [name for name in [*masses, *below] if name not in carried]
    roots = list(dict.fromkeys(roots))

    # collects a link and the links fixed to it: masses in its frame, moving joints, and links with their poses in it
    def gather(name, X):
        parts, moving, tied = [], [], []
        mass = masses.get(name)
        if mass is not None:
            parts.append((mass[0], X[:3, :3] @ mass[1] + X[:3, 3], X[:3, :3] @ mass[2] @ X[:3, :3].T))
        for joint in below.get(name, []):
            Y = X @ origin_of(joint)
            if joint.get("type") == "fixed":
                child = joint.find("child").get("link")
                more, others, links = gather(child, Y)
                parts, moving, tied = parts + more, moving + others, [*tied, (child, Y), *links]
            else:
                moving.append((joint, Y))
        return parts, moving, tied

    def write(name, X, elements, indent):
        parts, moving, tied = gather(name, np.eye(4))
        if not parts and not moving:
            return []
        if not parts:
            (joint, Y), = moving
            back = np.linalg.inv(Y)
            for one in elements:
                one.move(back)
            return write(joint.find("child").get("link"), X @ Y, [*elements, Element(joint)], indent)
        mass, center, tensor = combine(parts)
        moments, V = principal(tensor)
        space = "  " * indent
        lines = [f'{space}<body name="{name}" pos="{mjcf_vector(X[:3, 3])}" quat="{mjcf_vector(quaternion(X[:3, :3]))}">',
                 *(f"{space}  {one.text()}" for one in elements),
                 f'{space}  <inertial pos="{mjcf_vector(center)}" quat="{mjcf_vector(quaternion(V))}" mass="{mass!r}" '
                 f'diaginertia="{mjcf_vector(repaired(moments))}"/>']
        lines += [f'{space}  <body name="{link}" pos="{mjcf_vector(Y[:3, 3])}" '
                  f'quat="{mjcf_vector(quaternion(Y[:3, :3]))}"/>' for link, Y in tied]
        for joint, Y in moving:
            lines += write(joint.find("child").get("link"), Y, [Element(joint)], indent + 1)
        return [*lines, f"{space}</body>"]

    lines = ["<mujoco>", '  <compiler angle="radian"/>', "  <worldbody>"]
    for name in roots:
        if free_base and name not in ("world",) and masses.get(name) is not None:
            fly = ElementTree.Element("joint", name="base_free", type="floating")
            lines += write(name, np.eye(4), [Element(fly)], 2)
        else:
            for joint, Y in gather(name, np.eye(4))[1]:
                lines += write(joint.find("child").get("link"), Y, [Element(joint)], 2)
    return "\n".join([*lines, "  </worldbody>", "</mujoco>", ""])
