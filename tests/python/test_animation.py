"""Animated pictures: the facets of shapes, and the files."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polhode
import pytest
from conftest import PROGRAM
from polhode._animation import facets_of

PIL = pytest.importorskip("PIL.Image")


def _area(facets: list[Any]) -> float:
    """Returns the sum of the areas of planar facets."""
    total = 0.0
    for corners in facets:
        normal = sum(np.cross(a - corners[0], b - corners[0]) for a, b in zip(corners[1:], corners[2:]))
        total += float(np.linalg.norm(normal)) / 2
    return total


def _shape(kind: str, **sizes: Any) -> dict[str, Any]:
    part = {"type": kind, "sizes": sizes, "position": [1.0, 2.0, 3.0], "orientation": [0.8, 0.6, 0, 0], "hole": False}
    return {"parts": [part], "vertices": None, "faces": None, "points": None}


@pytest.mark.parametrize(("kind", "sizes", "area"), [
    ("box", {"half_extents": [1, 2, 3]}, 8 * (2 + 3 + 6)),
    ("sphere", {"radius": 2}, 16 * np.pi),
    ("cylinder", {"radius": 1, "half_height": 2}, 2 * np.pi + 8 * np.pi),
    ("hollow_cylinder", {"outer_radius": 2, "inner_radius": 1, "half_height": 1}, 2 * 3 * np.pi + 12 * np.pi),
    ("capsule", {"radius": 1, "half_height": 2}, 4 * np.pi + 8 * np.pi),
    ("cone", {"radius": 3, "height": 4}, 9 * np.pi + 15 * np.pi),
    ("torus", {"major_radius": 3, "minor_radius": 1}, 12 * np.pi**2),
    ("disc", {"radius": 2}, 4 * np.pi),
    ("plate", {"half_extents": [1, 2]}, 8),
    ("frustum", {"bottom_radius": 2, "top_radius": 2, "height": 3}, 8 * np.pi + 12 * np.pi),
    ("tetrahedron", {"vertices": [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]}, 1.5 + np.sqrt(3) / 2),
])
def test_facets_have_the_area_of_the_shape(kind: str, sizes: dict[str, Any], area: float) -> None:
    # polygons of 24 sides are inscribed: up to 3 % smaller
    found = _area(facets_of(_shape(kind, **sizes)))
    assert 0.965 * area < found <= area * (1 + 1e-12)


def test_a_frustum_is_about_its_center_of_mass() -> None:
    facets = facets_of({**_shape("frustum", bottom_radius=3, top_radius=0, height=4)})
    heights = (np.concatenate(facets) - [1, 2, 3]) @ [0, -0.96, 0.28]  # axis z of the part
    assert heights.min() == pytest.approx(-1)
    assert heights.max() == pytest.approx(3)


def test_a_body_without_shape_is_the_box_of_its_moments() -> None:
    # half extents 1, 2, 3 and mass 6: I_x = m (b^2 + c^2) / 3
    facets = facets_of({"parts": [], "vertices": None, "faces": None, "points": None, "mass": 6,
                        "moments": [26, 20, 10], "principal": [1, 0, 0, 0]})
    assert np.abs(np.concatenate(facets)).max(axis=0) == pytest.approx([1, 2, 3])


@pytest.mark.parametrize("name", ["turn.gif", "turn.png"])
def test_pictures_are_written(name: str, tmp_path: Path) -> None:
    motion = polhode.solve("mechanisms/double_pendulum", samples=10)
    file = motion.animation(tmp_path / name, frames=3, fps=10, size=(2, 2), dpi=50)
    with PIL.open(file) as picture:
        assert picture.n_frames == 3
        assert picture.size == (100, 100)


def test_motions_are_drawn_side_by_side(tmp_path: Path) -> None:
    motion = polhode.solve("free_asymmetric", samples=10)
    other = polhode.solve("free_asymmetric", "gyroscopic_none", step=0.1, samples=10)
    file = motion.animation(tmp_path / "beside.gif", frames=3, fps=10, size=(2, 2), dpi=50, beside=[other])
    with PIL.open(file) as picture:
        assert picture.n_frames == 3
        assert picture.size == (200, 100)


def test_a_strobe_picture_shows_the_bodies_at_some_times() -> None:
    motion = polhode.solve("bouncing_ball", samples=40)
    (frame,) = motion.strobe(5, size=(2, 2)).axes
    # the plane, and five times the body
    assert len(frame.collections) == 6
    (path,) = frame.lines
    assert len(path.get_data_3d()[0]) == 41
    # one body that flies far is enlarged
    thrown = polhode.solve({"name": "far", "duration": 1, "body": {"mass": 1, "shape": polhode.sphere(0.01)},
                            "initial": {"velocity": [100, 0, 0]}}, samples=20)
    figure = thrown.strobe()
    assert "bodies enlarged 357 times" in figure._suptitle.get_text()  # type: ignore[attr-defined]
    with pytest.raises(polhode.InputError, match="0 times of 41 samples"):
        motion.strobe(0)


def test_a_cell_needs_no_network() -> None:
    cell = polhode.solve("free_asymmetric", samples=4).animate(frames=2, size=(2, 2))
    text = cell if isinstance(cell, str) else cell.data
    assert text.count("data:image/png;base64") == 2
    assert "http" not in text and "<link" not in text and "fa-" not in text


def test_bad_requests_are_refused(tmp_path: Path) -> None:
    motion = polhode.solve("free_asymmetric", samples=4)
    with pytest.raises(polhode.InputError, match="unknown ending; give NAME.gif"):
        motion.animation(tmp_path / "turn.avi", frames=2)
    with pytest.raises(polhode.InputError, match="at least 2 frames"):
        motion.animation(tmp_path / "turn.gif", frames=1)
    assert not list(tmp_path.iterdir())


def test_the_command_writes_an_animated_picture(tmp_path: Path) -> None:
    # the program runs python3: the one that this module was built for
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    environment = {**os.environ, "PYTHONPATH": str(Path(polhode.__file__).parents[1]), "PATH": path}
    command = [PROGRAM, "animate", "t_handle", "--duration", "2", "--frames", "3", "--output"]
    done = subprocess.run([*command, str(tmp_path / "turn.gif")], check=False, capture_output=True, text=True,
                          env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    with PIL.open(tmp_path / "turn.gif") as picture:
        assert picture.n_frames == 3
    beside = subprocess.run([*command, str(tmp_path / "beside.gif"), "--beside", "gyroscopic_none", "--step", "0.1"],
                            check=False, capture_output=True, text=True, env=environment)
    assert (beside.returncode, beside.stderr) == (0, "")
    with PIL.open(tmp_path / "turn.gif") as one, PIL.open(tmp_path / "beside.gif") as two:
        assert two.size == (2 * one.size[0], one.size[1])
    (tmp_path / "beside.gif").unlink()
    refused = subprocess.run([*command, str(tmp_path / "turn.avi")], check=False, capture_output=True, text=True,
                             env=environment)
    assert refused.returncode == 2
    assert "turn.avi: unknown ending; give NAME.gif, NAME.png or NAME.mp4" in refused.stderr
    assert [file.name for file in tmp_path.iterdir()] == ["turn.gif"]
    missing = subprocess.run([*command, str(tmp_path / "other.gif")], check=False, capture_output=True, text=True,
                             env={**environment, "PYTHONPATH": str(tmp_path), "PYTHONNOUSERSITE": "1"})
    assert missing.returncode in (0, 2)  # 0 if the module is installed
    if missing.returncode == 2:
        assert "install python3-polhode" in missing.stderr
