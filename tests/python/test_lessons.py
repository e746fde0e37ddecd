"""Pages of lessons from Python."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path
from typing import Any

import polhode
import pytest

_BUILD = Path(polhode.__file__).absolute().parents[2]
needs_page = pytest.mark.skipif(not (_BUILD / "report/page.html").is_file(), reason="the page's front-end is not built")


def _lesson(**changes: Any) -> dict[str, Any]:
    phone = polhode.scene(name="phone", duration=3, body=polhode.body(mass=0.2, shape=polhode.box([0.04, 0.08, 0.004])),
                          initial=polhode.initial(angular_velocity=[9, 0.05, 0]))
    return {"name": "phone", "title": "A phone", "text": "It flips.", "scene": phone, "update": "gyroscopic_explicit",
            "step": 0.01, "graphs": ["energy"], **changes}


def _content(page: Path) -> Any:
    found = re.search(r'<script id="polhode-data"[^>]*>([^<]*)<', page.read_text(encoding="utf-8"))
    assert found is not None
    return json.loads(gzip.decompress(base64.b64decode(found[1])))["lessons"][0]


@needs_page
def test_a_mapping_with_a_scene_becomes_a_page(tmp_path: Path) -> None:
    lesson = _content(polhode.lesson_page(_lesson(), tmp_path / "phone.html"))
    assert lesson["title"] == "A phone" and lesson["scene"] == "phone" and lesson["angular_velocity"] == [9, 0.05, 0]
    # m (b^2 + c^2) / 3 of a box with these half extents
    assert lesson["inertia"][0] == pytest.approx(0.2 * (0.08**2 + 0.004**2) / 3, rel=1e-15)


@needs_page
def test_a_name_and_a_file_become_pages(tmp_path: Path) -> None:
    assert _content(polhode.lesson_page("tippe_top", tmp_path / "top.html"))["contact"]["friction"] == 0.3
    file = tmp_path / "own.json"
    file.write_text(json.dumps(_lesson(scene="t_handle")), encoding="utf-8")
    assert _content(polhode.lesson_page(file, tmp_path / "own.html"))["scene"] == "t_handle"


def test_faults_name_the_lesson(tmp_path: Path) -> None:
    for changes, message in (({"update": "gyroscopic_explicite"}, r"^the lesson: /update: is gyroscopic_explicite; did"),
                             ({"scene": "bouncing_ball"}, r"^the lesson: /scene: has a body .* m away from the plane"),
                             ({"step": 0}, r"^the lesson: /step: ")):
        with pytest.raises(polhode.InputError, match=message):
            polhode.lesson_page(_lesson(**changes), tmp_path / "bad.html")
    assert not list(tmp_path.iterdir())
