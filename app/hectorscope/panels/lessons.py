"""Lessons: sets up their scenes, and tells the pages what is needed to notice that a task is done."""

import html
import json
from operator import attrgetter
from typing import Any

import numpy as np

from hectorscope.common.resources import resource_folder
from hectorscope.page.lessons import FACTS, Lesson, lessons_in
from hectorscope.page.scene import Scene
from hectorscope.panels import _request
from hectorscope.panels._handles import put
from hectorscope.panels._truth_error import truth_error
from hectorscope.session.commands import SetUp
from hectorscope.session.snapshot import Snapshot


class LessonsPanel:
    """An invisible element with the facts that the conditions of the lessons name (static/lessons.js)."""

    title = "Lessons"
    order = 47
    rate = 3.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._lessons = {lesson.key: lesson for lesson in lessons_in(resource_folder("static") / "lessons")}
        self._mark = scene.server.gui.add_html(mark({}))
        _request.listen(scene, "lesson", self._asked)

    def draw(self, snapshot: Snapshot) -> None:
        """Tell what changed."""
        put(self._mark, mark(facts(snapshot, self._lessons)))

    def _asked(self, _client: int, asked: dict[str, Any]) -> None:
        """Set up the scene of a lesson, by its key; BadRequest for none."""
        lesson = self._lessons.get(str(asked.get("set_up")))
        if lesson is None:
            raise _request.BadRequest
        self._scene.send(SetUp(lesson.demo, lesson.offset_ns, lesson.settings, lesson.title))


def facts(snapshot: Snapshot, lessons: dict[str, Lesson]) -> dict[str, Any]:
    """What the run contributes: the recording, the time in seconds, and each setting that a lesson asks for.

    error: metres from the truth; left out where there is none.
    """
    error = truth_error(snapshot, max(0, len(snapshot.trajectory) - 1))["error"]
    playback = snapshot.playback
    settings = {each.fact for lesson in lessons.values() for each in lesson.done} - set(FACTS)
    return {
        "recording": snapshot.source,
        "time": round(max(0, playback.time_ns - playback.start_ns) / 1e9, 1),
        "tracking": snapshot.result.tracking if snapshot.result else "",
        **({"error": round(float(error[-1]), 3)} if np.isfinite(error).any() else {}),
        "compared": snapshot.compared is not None and snapshot.compared.whole,
        **{name: attrgetter(name)(snapshot.config) for name in sorted(settings)},
    }


def mark(told: dict[str, Any]) -> str:
    """The invisible element."""
    return f'<i class="hs-mark" data-hs-facts="{html.escape(json.dumps(told))}"></i>'


PANEL = LessonsPanel
