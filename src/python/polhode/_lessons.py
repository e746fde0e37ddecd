"""Pages of lessons: one HTML file with text, sliders, the reference beside an update, and graphs."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from polhode import _polhode
from polhode._scenes import scene as make_scene


def _find_front_end() -> None:
    """Sets the place of the page's front-end, which the program finds beside itself, for the build and installations."""
    places = Path(_polhode.__file__).resolve().parents
    for place in (places[2] / "report", places[min(4, len(places) - 1)] / "share" / "polhode" / "report"):
        if (place / "page.html").is_file():
            os.environ.setdefault("POLHODE_REPORT_PAGE", str(place / "page.html"))
            return


def lesson_page(lesson: str | os.PathLike[str] | Mapping[str, Any], path: str | os.PathLike[str]) -> Path:
    """Writes the page of a lesson, as ``polhode report --lesson``. The page computes everything itself.

    Parameters
    ----------
    lesson : str, path or mapping
        A built-in lesson, a lesson file, or the content of one. In a mapping, ``scene`` may be a scene or a mapping
        instead of a name or path.
    path : str or path
        NAME.html.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If the lesson is invalid. The message names the place and a remedy.

    Examples
    --------
    >>> import polhode
    >>> polhode.lesson_page({"name": "top", "title": "A top", "text": "..", "scene": "lagrange_top",
    ...                      "update": "gyroscopic_none", "step": -1}, "top.html")
    Traceback (most recent call last):
    ..
    polhode.InputError: the lesson: /step: is -1; give a number > 0
    """
    _find_front_end()
    if not isinstance(lesson, Mapping):
        return Path(_polhode.write_lesson_page(os.fspath(lesson), os.fspath(path)))
    with tempfile.TemporaryDirectory() as folder:
        content = dict(lesson)
        if isinstance(content.get("scene"), Mapping):
            (Path(folder) / "scene.json").write_text(make_scene(content["scene"]).expanded().json(), encoding="utf-8")
            content["scene"] = "scene.json"
        file = Path(folder) / "lesson.json"
        file.write_text(json.dumps(content), encoding="utf-8")
        try:
            return Path(_polhode.write_lesson_page(str(file), os.fspath(path)))
        except _polhode.InputError as error:
            raise _polhode.InputError(str(error).replace(str(file), "the lesson")) from None
