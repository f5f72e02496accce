"""What every view promises, found in the folder: a new one is held to it too."""

from typing import Any

import pytest

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.views import View, view_classes
from tests.page import restarted, room_snapshot, without_filter

VIEWS = pytest.mark.parametrize("view", view_classes(), ids=lambda view: view.__name__)
SETTINGS: list[dict[str, Any]] = [
    {"points": "height"},
    {"points": "plain", "ellipse_scale": 1000.0},
]


def messages(scene: Scene) -> int:
    """How many messages were ever queued for browsers."""
    return int(scene.server._websock_server._broadcast_buffer.message_counter)


def whole(view: type[View], scene: Scene) -> View:
    """The view with all of its layers asked for."""
    made = view(scene)
    for layer in scene.layers:
        scene.ask(layer)
    return made


@VIEWS
def test_it_draws_whatever_a_run_shows(view: type[View], scene: Scene) -> None:
    """Nothing yet, a first scan, a full picture, a run begun again, and the picture once more: no error."""
    made = whole(view, scene)
    full = room_snapshot()
    for snapshot in (Snapshot(), without_filter(full), full, restarted(full), full):
        made.draw(snapshot)


@VIEWS
def test_it_follows_every_setting(view: type[View], scene: Scene) -> None:
    """Every size and colouring can be chosen while nothing moves."""
    made, snapshot = whole(view, scene), room_snapshot()
    made.draw(snapshot)
    for change in SETTINGS:
        scene.show(**change)
        made.draw(snapshot)


@VIEWS
def test_it_sends_nothing_when_nothing_changed(view: type[View], scene: Scene) -> None:
    """Drawing the same snapshot again costs no bytes."""
    made, snapshot = whole(view, scene), room_snapshot()
    made.draw(snapshot)
    before = messages(scene)
    made.draw(snapshot)
    assert messages(scene) == before


@VIEWS
def test_it_has_a_title(view: type[View], scene: Scene) -> None:
    """The title names it on the page when it fails."""
    assert view(scene).title
