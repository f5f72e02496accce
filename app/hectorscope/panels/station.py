"""The operator's station: marks, the pose by hand, the way back, mapping and recording (static/station.js)."""

import binascii
import json
from base64 import b64decode, b64encode
from functools import partial
from time import monotonic
from typing import Any

from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _request, _workspace
from hectorscope.panels._handles import put
from hectorscope.panels._link import link_html
from hectorscope.run.annotations import KINDS, LONGEST, MOST, Annotation
from hectorscope.run.pictures import MOST_SENT
from hectorscope.session.commands import Command, Configure
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station_commands import (
    EditMark,
    PutMark,
    PutPicture,
    Record,
    RemoveMark,
    Resume,
    SetPose,
    ShowReturn,
)

TURN = 7.0  # rad
MOST_NUMBERS = 1 << 31
RESUME_HINT = (
    "It ended without being closed. Its map takes the place of this one, which can be brought back for a minute."
)


class StationPanel:
    """The page draws it all. It is told what is new, and again each second: it may have been opened just now."""

    title = "Station"
    order = 61
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sent: tuple[str, int] = "", 0
        self._marks: tuple[Annotation, ...] = ()
        with _workspace.tab(scene, self.title, Icon.MAP_PIN):
            self._link = scene.server.gui.add_html("")
            scene.server.gui.add_html(FORM)
            self._resume = scene.server.gui.add_button(
                "Go on with the run before", hint=RESUME_HINT, visible=False
            )
        self._resume.on_click(lambda _: scene.send(Resume()))
        _request.listen(scene, "station", lambda _, asked: scene.send(command(asked)))
        _request.listen(scene, "pictures", self._show, for_viewers=True)

    def draw(self, snapshot: Snapshot) -> None:
        """Tell every page."""
        self._marks = snapshot.station.annotations
        put(self._link, link_html(snapshot.report.link))
        if self._resume.visible != snapshot.station.past:
            self._resume.visible = snapshot.station.past
        told = script_of(snapshot), int(monotonic())
        if told != self._sent:
            self._sent = told
            self._scene.run(told[0])

    def _show(self, client: int, asked: dict[str, Any]) -> None:
        """Give a browser the picture that it asks for."""
        key, asking = asked.get("key"), self._scene.server.get_clients().get(client)
        found = next((mark.picture for mark in self._marks if mark.picture and mark.picture.key == key), None)
        if found is not None and asking is not None:
            content = b64encode(found.content).decode()
            self._scene.run(f"window.hectorscope?.pictured?.('{found.key}', '{content}')", asking)


def command(asked: dict[str, Any]) -> Command:
    """What a page asks for; BadRequest for what no script of ours sends."""
    match asked:
        case {"mark": [kind, x, y, words]}:
            return PutMark(_kind(kind), _request.metres(x), _request.metres(y), _request.words(words, LONGEST))
        case {"edit": [number, kind, words]}:
            return EditMark(_request.whole(number, 0, MOST_NUMBERS), _kind(kind), _request.words(words, LONGEST))
        case {"picture": [number, content]}:
            return PutPicture(_request.whole(number, 0, MOST_NUMBERS), _bytes(content))
        case {"remove": number}:
            return RemoveMark(_request.whole(number, 0, MOST_NUMBERS))
        case {"pose": [x, y, yaw]}:
            return SetPose(_request.metres(x), _request.metres(y), _request.number(yaw, -TURN, TURN))
    return _switch(asked)


def _switch(asked: dict[str, Any]) -> Command:
    match asked:
        case {"way": bool(on)}:
            return ShowReturn(on)
        case {"record": bool(on)}:
            return Record(on)
        case {"mapping": bool(on)}:
            return Configure("map.update", on)
    raise _request.BadRequest


def _kind(word: Any) -> str:
    if word not in KINDS:
        raise _request.BadRequest
    return str(word)


def _bytes(content: Any) -> bytes:
    if not isinstance(content, str):
        raise _request.BadRequest
    try:
        return b64decode(content, validate=True)
    except binascii.Error as error:
        raise _request.BadRequest from error


def script_of(snapshot: Snapshot) -> str:
    """The call in the page; text that somebody wrote stays text."""
    station, result = snapshot.station, snapshot.result
    way = station.way_back
    told = {
        "live": snapshot.playback.live,
        "marks": [_listed(mark) for mark in station.annotations[:MOST]],
        "way": None if way is None else way.round(2).tolist(),
        "records": station.records,
        "recorded": round(station.recorded / 1e6, 1),
        "mapping": snapshot.config.map.update,
        "most": MOST_SENT,
        "lost": result is not None and result.tracking == "lost",
    }
    return f"window.hectorscope?.station?.({json.dumps(told)})"


def _listed(mark: Annotation) -> list[int | float | str]:
    return [mark.number, mark.kind, mark.x, mark.y, mark.text, mark.picture.key if mark.picture else ""]


_button = partial(_own.wide_button, "station")
FORM = (
    '<p class="hs-scope" title="Every page shows the same.">Shared by every browser</p><div class="hs-own">'
    '<label class="hs-own-row"><span>Mark</span><select aria-label="Kind of the mark" data-hs-station-kind>'
    + "".join(f'<option value="{kind}">{kind}</option>' for kind in KINDS)
    + f'</select><input type="text" maxlength="{LONGEST}" data-hs-station-text aria-label="Text of the mark"'
    ' placeholder="text, if any"></label>'
    + _button("mark", "Set the mark by a click", "Then click its place in the map. Escape gives up.")
    + '<ol class="hs-station-marks" data-hs-station-marks></ol>'
    + '<p class="hs-station-recorded" role="status" data-hs-station-picture-told></p>'
    + _button("way", "Show the way back", "A short way to the start over free cells, as the robot drives.")
    + _button("pose", "Set the pose by a drag", "Press where the robot is, drag to where it looks. Streams only.")
    + _button("mapping", "Pause mapping", "The map stays as it is, and the pose is still followed in it.")
    + _button("record", "Record the stream", "Every message of the stream, in the folder of --record.")
    + '<p class="hs-station-recorded" data-hs-station-recorded></p></div>'
    '<p class="hs-scope" title="Kept in this browser.">This browser only</p><div class="hs-own">'
    '<label class="hs-own-box"><input type="checkbox" data-hs-own="sound">Sound while tracking is lost</label>'
    "</div>"
)

PANEL = StationPanel
