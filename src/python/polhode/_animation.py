"""Animated pictures of motions, drawn by matplotlib."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._attitudes import matrices_of
from polhode._types import Array

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.figure import Figure

#: Colours of bodies, light enough that shading shows.
_COLORS = ["#5b8fd0", "#e0a13c", "#63b08a", "#c9708e", "#8f7fd0", "#7fb0c8"]

#: Facets around an axis.
_AROUND = 24

#: Quadrilaterals and other polygons, shape (corners, 3).
_Facets = list[Array]


def _lathe(profile: npt.ArrayLike) -> _Facets:
    """Returns the facets of a surface of revolution about z. `profile`: radius and z, shape (n, 2)."""
    angles = np.linspace(0, 2 * np.pi, _AROUND + 1)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    facets: _Facets = []
    rows = np.asarray(profile, dtype=np.float64)
    for (r, z), (next_r, next_z) in zip(rows, rows[1:]):
        for a, b in zip(circle, circle[1:]):
            facets.append(np.array([[*(r * a), z], [*(r * b), z], [*(next_r * b), next_z], [*(next_r * a), next_z]]))
    return facets


def _arc(radius: float, center: float, first: float, last: float, count: int) -> Array:
    """Returns an arc of a profile about (0, center): angles from the axis z, rad."""
    angles = np.linspace(first, last, count)
    return np.stack([radius * np.sin(angles), center + radius * np.cos(angles)], axis=-1)


def _box(half: npt.ArrayLike) -> _Facets:
    facets: _Facets = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            corners = np.zeros((4, 3))
            corners[:, axis] = side
            corners[:, (axis + 1) % 3] = [-1, 1, 1, -1]
            corners[:, (axis + 2) % 3] = [-1, -1, 1, 1]
            facets.append(corners * np.asarray(half, dtype=np.float64))
    return facets


def _tube(outer: float, inner: float, half: float) -> _Facets:
    return _lathe([(inner, -half), (outer, -half), (outer, half), (inner, half), (inner, -half)])


def _torus(major: float, minor: float) -> _Facets:
    angles = np.linspace(0, 2 * np.pi, _AROUND // 2 + 1)
    return _lathe(np.stack([major + minor * np.cos(angles), minor * np.sin(angles)], axis=-1))


def _capsule(radius: float, half: float) -> _Facets:
    return _lathe(np.concatenate([_arc(radius, half, 0, np.pi / 2, 7), _arc(radius, -half, np.pi / 2, np.pi, 7)]))


def _ellipsoid(semi_axes: npt.ArrayLike) -> _Facets:
    return [facet * np.asarray(semi_axes, dtype=np.float64) for facet in _lathe(_arc(1, 0, 0, np.pi, 13))]


def _frustum(bottom: float, top: float, height: float) -> _Facets:
    # the origin is the centre of mass
    below = height * (bottom**2 + 2 * bottom * top + 3 * top**2) / (4 * (bottom**2 + bottom * top + top**2))
    return _lathe([(0, -below), (bottom, -below), (top, height - below), (0, height - below)])


def _tetrahedron(vertices: npt.ArrayLike) -> _Facets:
    corners = np.asarray(vertices, dtype=np.float64).reshape(4, 3)
    return [corners[[i for i in range(4) if i != left_out]] for left_out in range(4)]


#: Facets of a shape of a scene file, in its own axes, by its type.
_SHAPES: dict[str, Callable[[dict[str, Any]], _Facets]] = {
    "box": lambda s: _box(s["half_extents"]),
    "sphere": lambda s: _ellipsoid([s["radius"]] * 3),
    "hollow_sphere": lambda s: _ellipsoid([s["outer_radius"]] * 3),
    "cylinder": lambda s: _tube(s["radius"], 0, s["half_height"]),
    "hollow_cylinder": lambda s: _tube(s["outer_radius"], s["inner_radius"], s["half_height"]),
    "capsule": lambda s: _capsule(s["radius"], s["half_height"]),
    "cone": lambda s: _frustum(s["radius"], 0, s["height"]),
    "ellipsoid": lambda s: _ellipsoid(s["semi_axes"]),
    "torus": lambda s: _torus(s["major_radius"], s["minor_radius"]),
    "rod": lambda s: _tube(s["length"] / 50, 0, s["length"] / 2),
    "disc": lambda s: _lathe([(0, 0), (s["radius"], 0)]),
    "plate": lambda s: _box([*s["half_extents"], 0])[-1:],
    "tetrahedron": lambda s: _tetrahedron(s["vertices"]),
    "frustum": lambda s: _frustum(s["bottom_radius"], s["top_radius"], s["height"]),
}


def facets_of(shape: dict[str, Any]) -> _Facets:
    """Returns the facets of a body in its axes, from its centre of mass; without a shape, of the box of its moments."""
    facets: _Facets = []
    for part in shape["parts"]:
        if not part["hole"]:
            turn = matrices_of(part["orientation"])
            facets += [facet @ turn.T + part["position"] for facet in _SHAPES[part["type"]](part["sizes"])]
    if shape["vertices"]:
        vertices = np.reshape(shape["vertices"], (-1, 3))
        facets += list(vertices[np.reshape(shape["faces"], (-1, 3))])
    points = np.reshape(shape["points"] or [], (-1, 3))
    size = 0.06 * float(np.abs(points).max(initial=0.0)) or 0.05
    facets += [facet + point for point in points for facet in _ellipsoid([size] * 3)]
    if not facets and not (shape["mass"] > 0 and max(shape["moments"]) > 0):
        facets = _ellipsoid([0.05] * 3)  # a point, or a body without mass
    if not facets:
        # a homogeneous box: a^2 = 3 (I_y + I_z - I_x) / (2 m)
        moments = np.array(shape["moments"])
        squares = 1.5 * (moments.sum() - 2 * moments) / shape["mass"]
        half = np.sqrt(np.maximum(squares, 1e-4 * squares.max()))
        facets = [facet @ matrices_of(shape["principal"]).T for facet in _box(half)]
    return facets


class _Stage:
    """A body-fixed drawing of all bodies, and the frame of space that their motion (a Trajectory) needs."""

    def __init__(self, motion: Any) -> None:
        shapes = json.loads(motion._native.scene.shapes())
        self.bodies = [facets_of(shape) for shape in shapes]
        count = len(shapes)
        self.q = motion.q.reshape(len(motion.t), count, 4)
        self.p = motion.p.reshape(len(motion.t), count, 3)
        self.R = matrices_of(self.q)
        reach = [max(float(np.linalg.norm(facet, axis=1).max()) for facet in facets) for facets in self.bodies]
        self.reach = max(reach)
        spheres = np.array(reach)[None, :, None]
        self.low = (self.p - spheres).min(axis=(0, 1))
        self.high = (self.p + spheres).max(axis=(0, 1))
        self.planes = motion.scene.get("planes", [])

    def cube(self) -> tuple[Array, float]:
        """Returns the centre and half the side of the cube that is drawn."""
        return (self.low + self.high) / 2, 0.5 * float((self.high - self.low).max())

    def polygons(self, row: int, enlarged: float = 1.0) -> Iterator[tuple[int, Array]]:
        """Returns body and corners (world axes) of each facet at a sample, enlarged about the centre of mass."""
        for body, facets in enumerate(self.bodies):
            for facet in facets:
                yield body, enlarged * facet @ self.R[row, body].T + self.p[row, body]

    def tips(self) -> Iterator[Array]:
        """Returns the path of each body's point furthest from its centre of mass, of several bodies of the centre."""
        for body, facets in enumerate(self.bodies):
            corners = np.concatenate(facets)
            furthest = corners[np.linalg.norm(corners, axis=1).argmax()] if len(self.bodies) == 1 else np.zeros(3)
            yield self.p[:, body] + self.R[:, body] @ furthest

    def ground(self) -> list[Array]:
        """Returns a square of each plane."""
        center, half = self.cube()
        squares = []
        for plane in self.planes:
            n = np.asarray(plane["normal"], dtype=np.float64)
            size = np.linalg.norm(n)
            n, offset = n / size, plane.get("offset", 0) / size
            across = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
            across /= np.linalg.norm(across)
            along = np.cross(n, across)
            foot = center - (n @ center - offset) * n
            squares.append(np.array([foot + half * (a * across + b * along) for a, b in
                                     ((-1, -1), (1, -1), (1, 1), (-1, 1))]))
        return squares


def _shaded(polygons: list[tuple[int, Array]]) -> list[tuple[float, float, float]]:
    """Returns the colour of each facet: that of its body, lighter towards the lamp."""
    from matplotlib.colors import to_rgb

    lamp = np.array([0.4, -0.5, 0.77])
    colors = []
    for body, corners in polygons:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if not np.linalg.norm(normal) > 0:  # a triangle whose first two corners coincide
            normal = np.cross(corners[2] - corners[0], corners[3] - corners[0]) if len(corners) > 3 else lamp
        light = abs(float(normal @ lamp)) / max(float(np.linalg.norm(normal)), 1e-300)
        red, green, blue = (min(1.0, part * (0.45 + 0.6 * light)) for part in to_rgb(_COLORS[body % len(_COLORS)]))
        colors.append((red, green, blue))
    return colors


class _Panel:
    """The drawing of one motion in a part of the figure."""

    def __init__(self, figure: Any, place: tuple[int, int, int], stage: _Stage, motion: Any, wanted: Array) -> None:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        self.stage, self.motion = stage, motion
        # each frame shows the sample nearest to its time
        self.rows = np.abs(motion.t[None, :] - wanted[:, None]).argmin(axis=1)
        self.space = figure.add_subplot(*place, projection="3d")
        self.bodies = Poly3DCollection([], edgecolor="#00000030", linewidth=0.3)
        for square in stage.ground():
            self.space.add_collection3d(Poly3DCollection([square], facecolor="#999999", alpha=0.25, edgecolor="#777777"))
        self.space.add_collection3d(self.bodies)

    def set_cube(self, center: Array, half: float) -> None:
        for axis, middle in zip("xyz", center):
            getattr(self.space, f"set_{axis}lim")(middle - half, middle + half)
            getattr(self.space, f"set_{axis}label")(f"{axis} (m)")
        self.space.set_box_aspect((1, 1, 1))

    def draw(self, frame: int) -> float:
        """Draws a frame and returns its time, s."""
        row = int(self.rows[frame])
        polygons = list(self.stage.polygons(row))
        self.bodies.set_verts([corners for _, corners in polygons])
        self.bodies.set_facecolor(_shaded(polygons))
        return float(self.motion.t[row])


def animate(motion: Any, *, frames: int, fps: float, size: tuple[float, float], beside: Sequence[Any] = ()) -> FuncAnimation:
    """Makes the animation of a Trajectory, and of others beside it in the same cube of space."""
    import matplotlib.pyplot as plt
    from matplotlib.animation import FuncAnimation

    motions = [motion, *beside]
    if min(len(one.t) for one in motions) < 2:
        raise _polhode.InputError("the motion has fewer than 2 samples; solve it with more")
    if frames < 2 or not fps > 0:
        raise _polhode.InputError(f"{frames} frames at {fps} per second; give at least 2 frames and a rate > 0")
    stages = [_Stage(one) for one in motions]
    figure = plt.figure(figsize=(size[0] * len(motions), size[1]))
    wanted = np.linspace(motion.t[0], motion.t[-1], frames)
    panels = [_Panel(figure, (1, len(motions), k), stage, one, wanted)
              for k, (stage, one) in enumerate(zip(stages, motions), 1)]
    low, high = np.min([stage.low for stage in stages], axis=0), np.max([stage.high for stage in stages], axis=0)
    for panel in panels:
        panel.set_cube((low + high) / 2, 0.5 * float((high - low).max()))
        if beside:
            panel.space.set_title(panel.motion.method, fontsize="medium")
    heading = figure.suptitle("", fontsize="medium")
    name = ", ".join([motion.scene.get("name", ""), *([] if beside else [motion.method])])

    def draw(frame: int) -> list[Any]:
        times = [panel.draw(frame) for panel in panels]
        heading.set_text(f"{name}, t = {times[0]:.2f} s")
        return [*(panel.bodies for panel in panels), heading]

    animation = FuncAnimation(figure, draw, frames=frames, interval=1000 / fps)
    # the figure belongs to the animation, not to the notebook
    plt.close(figure)
    return animation


def strobe(motion: Any, *, count: int, size: tuple[float, float]) -> Figure:
    """Draws the bodies of a Trajectory at several times in one picture, the earlier the paler."""
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    if count < 1 or len(motion.t) < 1:
        raise _polhode.InputError(f"{count} times of {len(motion.t)} samples; give at least one of each")
    stage = _Stage(motion)
    figure = plt.figure(figsize=size)
    space = figure.add_subplot(projection="3d", computed_zorder=False)
    center, half = stage.cube()
    for axis, middle in zip("xyz", center):
        getattr(space, f"set_{axis}lim")(middle - half, middle + half)
        getattr(space, f"set_{axis}label")(f"{axis} (m)")
    space.set_box_aspect((1, 1, 1))
    for square in stage.ground():
        space.add_collection3d(Poly3DCollection([square], facecolor="#999999", alpha=0.25, edgecolor="#777777"))
    # bodies too small to be seen in the whole path are enlarged
    enlarged = max(1.0, half / (14 * stage.reach))
    rows = np.unique(np.linspace(0, len(motion.t) - 1, count).round().astype(int))
    for place, row in enumerate(rows):
        polygons = list(stage.polygons(int(row), enlarged))
        alpha = 1.0 if len(rows) == 1 else 0.15 + 0.85 * (place / (len(rows) - 1)) ** 2
        colors = [(*color, alpha) for color in _shaded(polygons)]
        faces = Poly3DCollection([corners for _, corners in polygons], facecolor=colors,
                                 edgecolor=(0, 0, 0, 0.2 * alpha), linewidth=0.3, zorder=2 + place)
        space.add_collection3d(faces)
    for body, path in enumerate(stage.tips()):
        space.plot(*path.T, color=_COLORS[body % len(_COLORS)], linewidth=0.8, alpha=0.8, zorder=1)
    about = f"{motion.scene.get('name', '')}, {motion.t[0]:g} to {motion.t[-1]:g} s"
    figure.suptitle(about + (f"\nbodies enlarged {enlarged:.0f} times" if enlarged > 1 else ""), fontsize="small")
    return figure


#: The buttons of matplotlib's player, whose icons would come from the network.
_BUTTONS = {"minus": "\N{MINUS SIGN}", "fast-backward": "\N{LEFT-POINTING DOUBLE ANGLE QUOTATION MARK}",
            "step-backward": "\N{SINGLE LEFT-POINTING ANGLE QUOTATION MARK}",
            "play fa-flip-horizontal": "\N{BLACK LEFT-POINTING TRIANGLE}", "pause": "\N{DOUBLE VERTICAL LINE}",
            "play": "\N{BLACK RIGHT-POINTING TRIANGLE}",
            "step-forward": "\N{SINGLE RIGHT-POINTING ANGLE QUOTATION MARK}",
            "fast-forward": "\N{RIGHT-POINTING DOUBLE ANGLE QUOTATION MARK}", "plus": "+"}


def cell(animation: FuncAnimation, fps: float) -> str:
    """Returns an animation as HTML with a player, without references to the network."""
    text: str = animation.to_jshtml(fps=fps)
    text = re.sub(r"<link\b[^>]*>", "", text)
    for icon, sign in _BUTTONS.items():
        text = text.replace(f'<i class="fa fa-{icon}"></i>', sign)
    return text


def _gif_writer(fps: float) -> Any:
    """Returns a writer of GIFs with one palette for all frames, so that frames store only what changes."""
    from matplotlib.animation import PillowWriter
    from PIL import Image

    class Writer(PillowWriter):  # type: ignore[misc]
        def finish(self) -> None:
            frames = [frame.convert("RGB") for frame in self._frames]
            # the colours of a frame in the middle, and one index for pixels that do not change
            unchanged = 63
            colors = frames[len(frames) // 2].quantize(unchanged, dither=0).getpalette()[: 3 * unchanged]
            colors += colors[:3] * (256 - len(colors) // 3)
            palette = Image.new("P", (1, 1))
            palette.putpalette(colors)
            indices = [np.asarray(frame.quantize(palette=palette, dither=0)) for frame in frames]
            # further entries of the palette repeat the first
            indices = [np.where(one < unchanged, one, 0).astype(np.uint8) for one in indices]
            for k in range(len(indices) - 1, 0, -1):
                indices[k] = np.where(indices[k] == indices[k - 1], unchanged, indices[k]).astype(np.uint8)
            pictures = [Image.fromarray(one, "P") for one in indices]
            for picture in pictures:
                picture.putpalette(colors)
            pictures[0].save(self.outfile, save_all=True, append_images=pictures[1:], duration=int(1000 / self.fps),
                             loop=0, optimize=False, transparency=unchanged, disposal=1)

    return Writer(fps=fps)


def save(animation: FuncAnimation, path: Path, fps: float, dpi: float) -> None:
    """Writes an animation as GIF, animated PNG or MP4, under a temporary name first. Raises InputError."""
    ending = path.suffix.lower()
    if ending not in (".gif", ".png", ".mp4"):
        raise _polhode.InputError(f"{path}: unknown ending; give NAME.gif, NAME.png or NAME.mp4")
    if ending == ".mp4" and not shutil.which("ffmpeg"):
        raise _polhode.InputError(f"{path}: MP4 needs ffmpeg; install it, or give NAME.gif or NAME.png")
    new = path.with_name(f".{path.stem}.{os.getpid()}{ending}")
    writer: Any = _gif_writer(fps) if ending == ".gif" else "ffmpeg" if ending == ".mp4" else "pillow"
    try:
        animation.save(str(new), writer=writer, fps=None if ending == ".gif" else fps, dpi=dpi)
        with new.open("rb+") as file:
            os.fsync(file.fileno())
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)
