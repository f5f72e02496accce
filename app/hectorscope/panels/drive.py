"""Driving a simulated robot: what is asked for it, and what the page shows of it (static/drive.js)."""

import html
import json
from typing import Any

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.panels import _request
from hectorscope.panels._handles import put
from hectorscope.session.commands import Drive
from hectorscope.session.snapshot import Snapshot
from hectorscope.steering import FAULTS, PutBox, Request, SetDoor, SetFault, Steer, TakeBox

MOST = 100  # doors or boxes
FARTHEST = 1e3  # metres


class DrivePanel:
    """An invisible element with the state of the robot; nothing while no robot is driven."""

    title = "Drive"
    order = 46
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._driven = False
        self._mark = scene.server.gui.add_html(mark(Snapshot()))
        _request.listen(scene, "drive", self._asked)

    def draw(self, snapshot: Snapshot) -> None:
        """Tell what changed."""
        self._driven = snapshot.drive is not None
        put(self._mark, mark(snapshot))

    def _asked(self, _client: int, asked: dict[str, Any]) -> None:
        wanted = request(asked)
        if self._driven:
            self._scene.send(Drive(wanted))


def request(asked: dict[str, Any]) -> Request:
    """What a page asks for; BadRequest for what no script of ours sends. Values are brought into their ranges."""
    match asked:
        case {"steer": [forward, turn]}:
            return Steer(_request.number(forward, -1.0, 1.0), _request.number(turn, -1.0, 1.0))
        case {"fault": str(name), "value": value} if name in FAULTS:
            return SetFault(name, _request.number(value, FAULTS[name].low, FAULTS[name].high))
        case {"door": number, "open": bool(is_open)}:
            return SetDoor(_request.whole(number, 0, MOST), is_open)
        case {"box": number, "at": [x, y]}:
            at = (_request.number(x, -FARTHEST, FARTHEST), _request.number(y, -FARTHEST, FARTHEST))
            return PutBox(_request.whole(number, 0, MOST), at)
        case {"box": number, "at": "ahead"}:
            return PutBox(_request.whole(number, 0, MOST), None)
        case {"box": number, "at": None}:
            return TakeBox(_request.whole(number, 0, MOST))
    raise _request.BadRequest


def mark(snapshot: Snapshot) -> str:
    """The invisible element; empty while no robot is driven."""
    state = snapshot.drive
    if state is None:
        return ""
    told = {
        "world": state.world,
        "faults": [
            {"name": name, "title": each.title, "unit": each.unit, "low": each.low, "high": each.high}
            | {"value": state.faults[name]}
            for name, each in FAULTS.items()
        ],
        "doors": state.doors,
        "boxes": [place is not None for place in state.boxes],
        "found": found(snapshot),
    }
    return f'<i class="hs-mark" data-hs-drive="{html.escape(json.dumps(told))}"></i>'


def found(snapshot: Snapshot) -> dict[str, str]:
    """What the filter estimates of the faults that it knows: by name, in their units."""
    navigation = snapshot.result.navigation if snapshot.result else None
    if navigation is None:
        return {}
    gyro = ", ".join(f"{value:+.2f}" for value in np.degrees(navigation.gyro_bias))
    return {"gyro_bias": f"{gyro} °/s", "accel_bias": f"{navigation.accel_bias[0]:+.2f} m/s²"}


PANEL = DrivePanel
