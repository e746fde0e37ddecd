"""An independent reader of SDFormat: converts links and joints to MJCF for MuJoCo.

It is based only on the specification (versions 1.3 to 1.12, http://sdformat.org) and shares no code with polhode. Every
document is first converted to the semantics of version 1.7 and later, by the specification's rules. Then the pose of
each frame and the link that it is attached to are resolved, scope by scope. Elements that do not affect these motions
are not read: limits, friction, contact, sensors.

Errors are SdfError. Poses are 4x4 matrices of binary64.
"""
import math
import pathlib
import xml.etree.ElementTree as ElementTree

import numpy as np


class SdfError(Exception):
    """An input that the specification does not allow or this reader does not support."""


def rotation_rpy(r, p, y):
    """Rz(y) Ry(p) Rx(r)."""
    cr, sr, cp, sp, cy, sy = math.cos(r), math.sin(r), math.cos(p), math.sin(p), math.cos(y), math.sin(y)
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def rotation_quaternion(w, x, y, z):
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def quaternion(R):
    """The quaternion of a rotation matrix, w first, computed from its largest component."""
    squares = [1 + R[0, 0] + R[1, 1] + R[2, 2], 1 + R[0, 0] - R[1, 1] - R[2, 2],
               1 - R[0, 0] + R[1, 1] - R[2, 2], 1 - R[0, 0] - R[1, 1] + R[2, 2]]
    k = int(np.argmax(squares))
    q = [[squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
         [R[2, 1] - R[1, 2], squares[1], R[1, 0] + R[0, 1], R[0, 2] + R[2, 0]],
         [R[0, 2] - R[2, 0], R[1, 0] + R[0, 1], squares[2], R[2, 1] + R[1, 2]],
         [R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[2, 1] + R[1, 2], squares[3]]][k]
    return np.array(q) / np.linalg.norm(q)


def placed(R=None, p=(0, 0, 0)):
    X = np.eye(4)
    X[:3, :3] = np.eye(3) if R is None else R
    X[:3, 3] = p
    return X


def principal(tensor):
    """Principal moments and a right-handed rotation of the axes to them: tensor = V diag V^T."""
    moments, V = np.linalg.eigh(tensor)
    if np.linalg.det(V) < 0:
        V[:, 0] = -V[:, 0]
    return moments, V


# ---- XML

def text_of(at, name, default=None):
    found = at.find(name)
    return default if found is None or found.text is None or not found.text.strip() else found.text.strip()


def number_of(at, name, default):
    return float(text_of(at, name, default))


def true_of(text):
    return str(text).strip().lower() in ("true", "1")


def numbers(text):
    return [float(x) for x in text.split()]


def raw_pose(at):
    """The pose of a <pose> element, without its relative_to."""
    if at is None or at.text is None or not at.text.strip():
        return np.eye(4)
    x = numbers(at.text)
    if at.get("rotation_format", "euler_rpy") == "quat_xyzw":
        return placed(rotation_quaternion(x[6], x[3], x[4], x[5]), x[:3])
    unit = math.pi / 180 if true_of(at.get("degrees", "false")) else 1
    return placed(rotation_rpy(*(unit * a for a in x[3:6])), x[:3])


def version_of(root):
    return tuple(int(x) for x in root.get("version").split("."))


def convert(root):
    """Brings a document to the semantics of 1.7 and later."""
    version = version_of(root)
    for joint in root.iter("joint"):
        for axis in [*joint.findall("axis"), *joint.findall("axis2")]:
            old = axis.find("use_parent_model_frame")
            in_model = version < (1, 5) or (version < (1, 7) and old is not None and true_of(old.text))
            if in_model and axis.find("xyz") is not None:
                axis.find("xyz").set("expressed_in", "__model__")
    if version < (1, 7):
        for pose in root.iter("pose"):
            if pose.get("frame"):
                pose.set("relative_to", pose.get("frame"))
        # if a joint and a link have the same name, the frame of the joint gets another name
        for model in root.iter("model"):
            links = {link.get("name") for link in model.findall("link")}
            for joint in model.findall("joint"):
                if joint.get("name") in links:
                    joint.set("name", joint.get("name") + "_joint")
    if version < (1, 6):
        for world in root.iter("world"):
            inner = world.find("physics/gravity")
            if inner is not None and world.find("gravity") is None:
                world.append(inner)


# ---- mass

def mesh_moments(path, scale):
    """Volume, first and second moments of a closed mesh (OBJ), by tetrahedra from the origin."""
    vertices, volume, first, second = [], 0.0, np.zeros(3), np.zeros((3, 3))
    for line in path.read_text().splitlines():
        word = line.split()
        if word[:1] == ["v"]:
            vertices.append(np.array([float(x) for x in word[1:4]]) * scale)
        if word[:1] == ["f"]:
            corners = [vertices[int(x.split("/")[0]) - 1] for x in word[1:]]
            for b, c in zip(corners[1:], corners[2:]):
                T = np.array([corners[0], b, c])
                v = np.linalg.det(T) / 6
                s = T.sum(axis=0)
                volume += v
                first += v * s / 4
                second += v / 20 * (T.T @ T + np.outer(s, s))
    return (volume, first, second) if volume > 0 else (-volume, -first, -second)


def shape_mass(geometry, density, folder):
    """Mass, centre and tensor about it, in the shape's own frame."""
    shape = geometry[0]
    kind = shape.tag
    center = np.zeros(3)
    if kind == "box":
        x, y, z = numbers(text_of(shape, "size", "1 1 1"))
        m = density * x * y * z
        diagonal = [m / 12 * (y * y + z * z), m / 12 * (x * x + z * z), m / 12 * (x * x + y * y)]
    elif kind == "sphere":
        r = number_of(shape, "radius", 1)
        m = density * 4 / 3 * math.pi * r ** 3
        diagonal = [0.4 * m * r * r] * 3
    elif kind == "ellipsoid":
        a, b, c = numbers(text_of(shape, "radii", "1 1 1"))
        m = density * 4 / 3 * math.pi * a * b * c
        diagonal = [m / 5 * (b * b + c * c), m / 5 * (a * a + c * c), m / 5 * (a * a + b * b)]
    elif kind == "cylinder":
        r, h = number_of(shape, "radius", 1), number_of(shape, "length", 1)
        m = density * math.pi * r * r * h
        diagonal = [m * (3 * r * r + h * h) / 12] * 2 + [m * r * r / 2]
    elif kind == "capsule":
        r, h = number_of(shape, "radius", 0.5), number_of(shape, "length", 1)
        tube, ball = density * math.pi * r * r * h, density * 4 / 3 * math.pi * r ** 3
        m = tube + ball
        # half balls: their centre is 3/8 r beyond the tube's ends
        across = tube * (3 * r * r + h * h) / 12 + ball * (0.4 * r * r + h * h / 4 + 3 * h * r / 8)
        diagonal = [across, across, tube * r * r / 2 + 0.4 * ball * r * r]
    elif kind == "cone":
        r, h = number_of(shape, "radius", 0.5), number_of(shape, "length", 1)
        m = density * math.pi * r * r * h / 3
        across = m * (3 / 20 * r * r + 3 / 80 * h * h)
        diagonal = [across, across, 0.3 * m * r * r]
        center = np.array([0, 0, -h / 4])  # the frame is at half the height
    elif kind == "mesh":
        scale = np.array(numbers(text_of(shape, "scale", "1 1 1")))
        volume, first, second = mesh_moments(folder / text_of(shape, "uri"), scale)
        m, center = density * volume, first / volume
        central = second - np.outer(first, first) / volume
        return m, center, density * (np.trace(central) * np.eye(3) - central)
    else:
        raise SdfError(f"no mass of a <{kind}>")
    return m, center, np.diag(diagonal)


def combine(parts):
    """Mass, centre and tensor about it of parts in one frame."""
    mass = sum(m for m, _, _ in parts)
    center = sum(m * c for m, c, _ in parts) / mass
    tensor = sum(I + m * (np.dot(c - center, c - center) * np.eye(3) - np.outer(c - center, c - center))
                 for m, c, I in parts)
    return mass, center, tensor


def link_mass(link, folder, scales_to_mass):
    inertial = link.find("inertial")
    if inertial is None:
        return 1.0, np.zeros(3), np.eye(3)
    if true_of(inertial.get("auto", "false")):
        parts = []
        for collision in link.findall("collision"):
            density = number_of(collision, "density", text_of(inertial, "density", 1000))
            m, c, I = shape_mass(collision.find("geometry"), density, folder)
            X = raw_pose(collision.find("pose"))
            parts.append((m, X[:3, :3] @ c + X[:3, 3], X[:3, :3] @ I @ X[:3, :3].T))
        mass, center, tensor = combine(parts)
        if scales_to_mass and inertial.find("mass") is not None:
            return number_of(inertial, "mass", 1), center, tensor * (number_of(inertial, "mass", 1) / mass)
        return mass, center, tensor
    given = inertial.find("inertia")
    value = {key: number_of(given, key, 1 if key[1] == key[2] else 0) if given is not None else float(key[1] == key[2])
             for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    tensor = np.array([[value["i" + "".join(sorted(a + b))] for b in "xyz"] for a in "xyz"])
    X = raw_pose(inertial.find("pose"))
    return number_of(inertial, "mass", 1), X[:3, 3], X[:3, :3] @ tensor @ X[:3, :3].T


# ---- frames

WORLD = ("world",)


class Scope:
    """A world or a model: its frames by name. Each has a raw pose, the frame that the pose is relative to, and the
    frame that it is attached to."""

    def __init__(self, outer, name, static=False):
        self.scales_to_mass = outer.scales_to_mass if outer is not None else False
        self.outer, self.name, self.static = outer, name, static or (outer is not None and outer.static)
        self.frames = {}  # name -> (raw pose, relative_to, attached_to, link or None)
        self.links, self.joints, self.inner = [], [], {}
        self.canonical, self.placement, self.pose, self.pose_relative_to = "", "", np.eye(4), ""
        self.resolved, self.busy, self.weightless = {}, set(), set()

    def path(self):
        return [] if self.outer is None else [*self.outer.path(), self.name]

    def find(self, name):
        """Resolves a name with :: to its scope and its name there."""
        if "::" in name:
            head, tail = name.split("::", 1)
            if head in self.inner:
                return self.inner[head].find(tail)
        return self, name

    def pose_of(self, name):
        """The pose of a frame in this scope's frame."""
        scope, own = self.find(name)
        if scope is not self:
            X = np.eye(4)
            at = scope
            while at is not self:
                X = at.in_outer() @ X
                at = at.outer
            return X @ scope.pose_of(own)
        if name in ("", "__model__", "world" if self.outer is None else "__model__"):
            return np.eye(4)
        if name in self.resolved:
            return self.resolved[name]
        if name in self.busy:
            raise SdfError(f"frame {name} is relative to itself")
        self.busy.add(name)
        if name in self.inner:
            X = self.inner[name].in_outer()
        elif name in self.frames:
            raw, relative_to, attached_to, _ = self.frames[name]
            X = self.pose_of(relative_to or attached_to) @ raw
        else:
            raise SdfError(f"no frame {name}")
        self.busy.discard(name)
        self.resolved[name] = X
        return X

    def in_outer(self):
        """The pose of this model's frame in the scope around it."""
        X = self.outer.pose_of(self.pose_relative_to) @ self.pose
        if self.placement:
            X = X @ np.linalg.inv(self.pose_of(self.placement))
        return X

    def in_world(self):
        return np.eye(4) if self.outer is None else self.outer.in_world() @ self.in_outer()

    def link_of(self, name):
        """The path of the link that a frame is attached to, or WORLD."""
        if name == "world":
            return WORLD
        scope, own = self.find(name)
        if scope is not self:
            return scope.link_of(own)
        if name in ("", "__model__"):
            if self.static or self.outer is None:
                return WORLD
            if self.canonical:
                return self.link_of(self.canonical)
            if self.links:
                return self.link_of(self.links[0][0])
            return self.link_of(next(iter(self.inner)))
        if name in self.inner:
            return self.inner[name].link_of("__model__")
        _, _, attached_to, link = self.frames[name]
        return (*self.path(), name) if link is not None else self.link_of(attached_to)


def read_included(folder, include):
    """The model that an <include> names, converted by its document's version, and the folder of that document."""
    uri = text_of(include, "uri")
    path = folder / uri.removeprefix("model://").removeprefix("file://")
    if path.is_dir():
        path = path / text_of(ElementTree.parse(path / "model.config").getroot(), "sdf")
    root = ElementTree.parse(path).getroot()
    convert(root)
    return root.find("model"), path.parent


def fill(scope, at, folder):
    """Reads the children of a <world> or <model> into its scope."""
    for child in at:
        if child.tag == "link":
            name = child.get("name")
            given = child.find("pose")
            scope.frames[name] = (raw_pose(given), given.get("relative_to", "") if given is not None else "", "", child)
            scope.links.append((name, link_mass(child, folder, scope.scales_to_mass)))
            if not true_of(text_of(child, "gravity", "true")):
                scope.weightless.add(name)
        elif child.tag == "frame":
            given = child.find("pose")
            scope.frames[child.get("name")] = (raw_pose(given),
                                               given.get("relative_to", "") if given is not None else "",
                                               child.get("attached_to", ""), None)
        elif child.tag == "joint":
            given = child.find("pose")
            scope.frames[child.get("name")] = (raw_pose(given),
                                               given.get("relative_to", "") if given is not None else "",
                                               text_of(child, "child"), None)
            scope.joints.append(child)
        elif child.tag == "model":
            read_model(scope, child, folder, None)
        elif child.tag == "include":
            inner, inner_folder = read_included(folder, child)
            if true_of(child.get("merge", "false")):
                merge(scope, inner, child, inner_folder)
            else:
                read_model(scope, inner, inner_folder, child)


def merge(scope, model, include, folder):
    """Adds the included model's elements to this scope, and its frame as a separate frame."""
    proxy = f"_merged__{model.get('name')}__model__"
    given = include.find("pose") if include.find("pose") is not None else model.find("pose")
    scope.frames[proxy] = (raw_pose(given), given.get("relative_to", "") if given is not None else "", "", None)
    for child in model:
        if child.tag not in ("link", "frame", "joint", "model", "include"):
            continue
        pose = child.find("pose")
        if child.tag != "joint" and not child.get("attached_to") and (pose is None or not pose.get("relative_to")):
            if pose is None:
                pose = ElementTree.SubElement(child, "pose")
            pose.set("relative_to", proxy)
        for one in child.iter():
            for key in ("relative_to", "expressed_in", "attached_to"):
                if one.get(key) == "__model__":
                    one.set(key, proxy)
            if one.tag in ("parent", "child") and one.text == "__model__":
                one.text = proxy
    fill(scope, model, folder)


def read_model(outer, at, folder, include):
    name = at.get("name")
    static = true_of(text_of(at, "static", "false"))
    given, placement = at.find("pose"), at.get("placement_frame", "")
    if include is not None:
        name = text_of(include, "name", name)
        static = true_of(text_of(include, "static", str(static)))
        if include.find("pose") is not None:
            given = include.find("pose")
            placement = text_of(include, "placement_frame", "")
    scope = Scope(outer, name, static)
    outer.inner[name] = scope
    scope.canonical, scope.placement = at.get("canonical_link", ""), placement
    scope.pose = raw_pose(given)
    scope.pose_relative_to = given.get("relative_to", "") if given is not None else ""
    fill(scope, at, folder)


def scopes(scope):
    yield scope
    for inner in scope.inner.values():
        yield from scopes(inner)


# ---- MJCF

def joint_axis(scope, joint, tag, joint_in_scope):
    axis = joint.find(tag)
    xyz = axis.find("xyz")
    v = np.array(numbers(xyz.text)) if xyz is not None else np.array([0.0, 0, 1])
    frame = xyz.get("expressed_in", "") if xyz is not None else ""
    R = scope.pose_of(frame)[:3, :3] if frame else joint_in_scope[:3, :3]
    return axis, R @ v / np.linalg.norm(v)


def mjcf_vector(v):
    return " ".join(repr(float(x)) for x in v)


AXES = {"revolute": ["axis"], "continuous": ["axis"], "prismatic": ["axis"], "universal": ["axis", "axis2"],
        "revolute2": ["axis", "axis2"], "ball": [],
        "fixed": []}


def read_joint(scope, joint, poses):
    """A joint between two links; point and axes are the child's."""
    name, kind = joint.get("name"), joint.get("type")
    if kind not in AXES:
        raise SdfError(f"joint {name} is a {kind}")
    parent, child = scope.link_of(text_of(joint, "parent")), scope.link_of(text_of(joint, "child"))
    here = scope.pose_of(name)
    to_child = np.linalg.inv(poses[child]) @ scope.in_world()  # from the scope's frame
    axes = []
    for tag in AXES[kind]:
        axis, v = joint_axis(scope, joint, tag, here)
        given = axis.find("dynamics")
        dynamics = {key: number_of(given, of, 0) if given is not None else 0.0
                    for key, of in (("damping", "damping"), ("stiffness", "spring_stiffness"),
                                    ("springref", "spring_reference"))}
        axes.append((to_child[:3, :3] @ v, dynamics))
    return {"name": "::".join([*scope.path(), name]), "type": kind, "parent": parent, "child": child,
            "point": to_child[:3, :3] @ here[:3, 3] + to_child[:3, 3], "axes": axes}


def read_sdf(path, scales_to_mass=False):
    """Reads a file. Returns, by path of the link: poses in the world, masses (mass, centre, tensor), links without
    gravity, static links; also the joints and the world's gravity, None for a file without a world.

    scales_to_mass: a <mass> with auto="true" scales the automatic inertia, as in libsdformat from 14.7 and 15.2 on;
    earlier versions ignore it."""
    path = pathlib.Path(path)
    root = ElementTree.parse(path).getroot()
    convert(root)
    world = Scope(None, "world")
    world.scales_to_mass = scales_to_mass
    at = root.find("world")
    fill(world, root if at is None else at, path.parent)

    robot = {"poses": {}, "masses": {}, "weightless": set(), "static": set(), "joints": [],
             "gravity": None if at is None else numbers(text_of(at, "gravity", "0 0 -9.8"))}
    for scope in scopes(world):
        X = scope.in_world()
        for name, mass in scope.links:
            own = (*scope.path(), name)
            robot["poses"][own], robot["masses"][own] = X @ scope.pose_of(name), mass
            if name in scope.weightless:
                robot["weightless"].add(own)
            if scope.static:
                robot["static"].add(own)
    for scope in scopes(world):
        if not scope.static:
            robot["joints"] += [read_joint(scope, joint, robot["poses"]) for joint in scope.joints]
    return robot


def joint_elements(joint):
    if joint["type"] == "ball":
        return [f'<joint name="{joint["name"]}" type="ball" pos="{mjcf_vector(joint["point"])}"/>']
    kind = "slide" if joint["type"] == "prismatic" else "hinge"
    return [f'<joint name="{joint["name"]}{"_2" if i else ""}" type="{kind}" pos="{mjcf_vector(joint["point"])}" '
            f'axis="{mjcf_vector(v)}"' + "".join(f' {key}="{x!r}"' for key, x in dynamics.items()) + "/>"
            for i, (v, dynamics) in enumerate(joint["axes"])]


def write_mjcf(robot):
    poses = robot["poses"]
    carrier = {own: (WORLD, []) for own in robot["static"]}
    for joint in robot["joints"]:
        if joint["child"] in carrier:
            raise SdfError(f"{'::'.join(joint['child'])} has two joints")
        carrier[joint["child"]] = (joint["parent"], joint_elements(joint))

    def body(own, indent):
        parent, elements = carrier.get(own, (WORLD, ["<freejoint/>"]))
        X = poses[own] if parent == WORLD else np.linalg.inv(poses[parent]) @ poses[own]
        mass, center, tensor = robot["masses"][own]
        moments, V = principal(tensor)
        space = "  " * indent
        gravity_off = ' gravcomp="1"' if own in robot["weightless"] else ""
        lines = [f'{space}<body name="{"::".join(own)}" pos="{mjcf_vector(X[:3, 3])}" '
                 f'quat="{mjcf_vector(quaternion(X[:3, :3]))}"{gravity_off}>',
                 *(f"{space}  {one}" for one in elements),
                 f'{space}  <inertial pos="{mjcf_vector(center)}" quat="{mjcf_vector(quaternion(V))}" '
                 f'mass="{mass!r}" diaginertia="{mjcf_vector(moments)}"/>']
        for other, (its_parent, _) in carrier.items():
            if its_parent == own:
                lines += body(other, indent + 1)
        return [*lines, f"{space}</body>"]

    lines = ["<mujoco>", '  <compiler angle="radian"/>', "  <worldbody>"]
    for own in poses:
        if carrier.get(own, (WORLD,))[0] == WORLD:
            lines += body(own, 2)
    return "\n".join([*lines, "  </worldbody>", "</mujoco>", ""])
