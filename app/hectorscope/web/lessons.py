"""The lessons as the page fetches them: one JSON file, made when the server starts."""

import json
from dataclasses import asdict
from pathlib import Path

from hectorscope.page.lessons import Lesson, lessons_in
from hectorscope.page.static_files import File


def lessons_file(static: Path) -> File:
    """All lessons in order; their texts are HTML by now. LessonError for a bad one."""
    return File("application/json", json.dumps([_told(each) for each in lessons_in(static / "lessons")]).encode())


def _told(lesson: Lesson) -> dict[str, object]:
    """What a page needs; the settings stay here, as the server sets up the scene."""
    names = ("key", "title", "body", "task", "browser")
    return {
        **{name: getattr(lesson, name) for name in names},
        "done": [asdict(each) for each in lesson.done],
        "question": asdict(lesson.question),
    }
