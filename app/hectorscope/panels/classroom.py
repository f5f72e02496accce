"""A class: what the teacher's browser looks at is told to every page, which may follow (static/classroom.js)."""

import hmac
import html
import json
from typing import Any

from hectorscope.page.scene import Scene
from hectorscope.panels import _request
from hectorscope.panels._handles import put
from hectorscope.session.snapshot import Snapshot

LAYOUTS = ("stacked", "side", "one")


class ClassroomPanel:
    """An invisible element with the teacher's view; nothing where the server was not started for a class.

    Only who brings the key of the teacher's link is heard.
    """

    title = "Class"
    order = 48
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._key = scene.teacher
        self._layers = frozenset(layer.key for layer in scene.layers)
        self._view: dict[str, Any] | None = None
        if self._key is None:
            return
        self._mark = scene.server.gui.add_html(mark(None))
        _request.listen(scene, "class", self._asked)

    def draw(self, _snapshot: Snapshot) -> None:
        """Tell what changed."""
        if self._key is not None:
            put(self._mark, mark(self._view))

    def _asked(self, _client: int, asked: dict[str, Any]) -> None:
        if self._key is None or not hmac.compare_digest(str(asked.get("key")).encode(), self._key.encode()):
            raise _request.BadRequest
        self._view = view(asked.get("view"), self._layers)


def view(asked: Any, layers: frozenset[str]) -> dict[str, Any]:
    """The view of the teacher, checked: camera, layout of the levels, layers; BadRequest for anything else."""
    match asked:
        case {"camera": [mode, *pose], "layout": layout, "gap": gap, "level": level, "layers": dict(shown)}:
            if mode not in ("free", "follow", "top", "fit") or layout not in LAYOUTS or len(pose) != 6:
                raise _request.BadRequest
            if not (shown.keys() <= layers and all(isinstance(each, bool) for each in shown.values())):
                raise _request.BadRequest
            return {
                "camera": [mode, *map(_request.metres, pose)],
                "layout": layout,
                "gap": _request.number(gap, 0.05, 2.0),
                "level": _request.whole(level, 0, _request.MOST_LEVELS - 1),
                "layers": shown,
            }
    raise _request.BadRequest


def mark(shown: dict[str, Any] | None) -> str:
    """The invisible element; {} before the teacher is there."""
    return f'<i class="hs-mark" data-hs-class="{html.escape(json.dumps(shown or {}))}"></i>'


PANEL = ClassroomPanel
