"""What a script of ours in a page asks for: JSON in a hidden text field, checked like all that browsers send."""

import json
import math
from collections.abc import Callable
from typing import Any

from viser import GuiEvent, GuiTextHandle

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene

FARTHEST = 1e6  # metres from the map's start
MOST_LEVELS = 32


class BadRequest(ValueError):
    """A value that no script of ours sends."""


def listen(
    scene: Scene, name: str, heard: Callable[[int, dict[str, Any]], None], *, for_viewers: bool = False
) -> None:
    """A hidden field for requests; static/requests.js finds it by its name. No other browser is told of them.

    heard: gets the number of the browser and what it asks for; BadRequest drops it. The callback is a coroutine,
    as these run in order, before another browser can write into the same field.
    for_viewers: what is asked for changes nothing for anybody else.
    """
    gui = scene.server.gui
    field = gui.add_text(name, "", visible=False)
    viser_private.keep_to_server(field)
    if for_viewers:
        scene.for_viewers.add(viser_private.uuid_of(field))
    gui.add_html(
        f'<i class="hs-mark" data-hs-request="{name}" data-hs-field="{viser_private.uuid_of(field)}"></i>'
    )

    async def asked(event: GuiEvent[GuiTextHandle]) -> None:
        if event.client_id is None:
            return
        try:
            request = json.loads(event.target.value)
            if isinstance(request, dict):
                heard(event.client_id, request)
        except (ValueError, OverflowError, RecursionError):  # BadRequest is a ValueError
            return

    field.on_update(asked)


def number(value: Any, low: float, high: float) -> float:
    """A finite number, brought into a range; BadRequest for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadRequest
    return min(max(float(value), low), high)


def whole(value: Any, low: int, high: int) -> int:
    """A whole number, brought into a range; BadRequest for anything else."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise BadRequest
    return min(max(value, low), high)


def metres(value: Any) -> float:
    """A coordinate in the map, within FARTHEST; BadRequest for what is no number."""
    return number(value, -FARTHEST, FARTHEST)


def place(value: Any) -> tuple[int, float, float]:
    """A place [level, x, y] of the map, metres, brought into its ranges; BadRequest for anything else."""
    match value:
        case [level, x, y]:
            return whole(level, 0, MOST_LEVELS - 1), metres(x), metres(y)
    raise BadRequest


def words(value: Any, longest: int) -> str:
    """A text without blanks around it, cut at `longest` characters; what is no character becomes a "?"."""
    if not isinstance(value, str):
        raise BadRequest
    return value.strip()[:longest].encode("utf-8", "replace").decode()


def items(value: Any, most: int) -> list[Any]:
    """A list of some items; BadRequest for anything else."""
    if not isinstance(value, list) or len(value) > most:
        raise BadRequest
    return value
