"""What a browser can take with it: files in formats to choose, a replay with notes, a picture, a video."""

from functools import partial
from typing import TYPE_CHECKING, Any

from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _request, _workspace
from hectorscope.panels._format import text
from hectorscope.run.notes import LAST_S, LONGEST, Note
from hectorscope.session.commands import Export
from hectorscope.session.snapshot import Snapshot

if TYPE_CHECKING:
    from hectorscope.exporters import Exporter

MOST = 100  # notes, and formats
REPLAY = "html"
TITLES = {
    "npz": "map.npz, for --map",
    "pgm": "Map: PGM + YAML, trinary",
    "scale": "Map: PGM + YAML, scale",
    "raw": "Map: PGM + YAML, raw",
    "png": "Map: PNG",
    "geotiff": "Map: GeoTIFF, rescue league",
    "tum": "Trajectory: TUM",
    "kitti": "Trajectory: KITTI",
    "config": "Settings: TOML",
    "metrics": "Figures of the run: JSON",
    "navigation": "State of the filter: CSV",
    "csv": "Figures of every scan: CSV",
    "mcap": "Result: MCAP for Foxglove and rerun",
    "pictures": "Pictures of the marks: ZIP",
    "report": "Report: HTML",
    REPLAY: "Replay with notes: HTML, no server",
}


class ExportPanel:
    """Each browser chooses for itself (static/export.js); what it asked for is sent to it alone."""

    title = "Export"
    order = 65
    rate = 4.0

    def __init__(self, scene: Scene) -> None:
        self._scene, self._source = scene, ""
        self._sent: dict[int, int] = {}
        with _workspace.tab(scene, self.title, Icon.DOWNLOAD):
            self._form = scene.server.gui.add_html("")
        _request.listen(scene, "export", lambda client, asked: scene.send(self._command(client, asked)))

    def draw(self, snapshot: Snapshot) -> None:
        """Send the archives that are new. The formats need numba: they are listed once the run has brought it."""
        if not self._form.content and snapshot.scans:
            self._form.content = form_html(self._scene.replay is not None)
        self._source = snapshot.source
        clients = self._scene.server.get_clients()
        for client, download in snapshot.downloads.items():
            if client in clients and self._sent.get(client) != download.number:
                self._sent[client] = download.number
                clients[client].send_file_download(download.name, download.content, save_immediately=True)

    def _command(self, client: int, asked: dict[str, Any]) -> Export:
        """{"formats": [names], "notes": [[seconds, text], ...]}; BadRequest for what no script of ours sends."""
        names = _request.items(asked.get("formats"), MOST)
        notes = [_note(*_request.items(each, 2)) for each in _request.items(asked.get("notes"), MOST)]
        known = {exporter.name: exporter for exporter in self._known(notes)}
        if not names or not all(isinstance(name, str) and name in known for name in names):
            raise _request.BadRequest
        return Export(client, tuple(known[name] for name in dict.fromkeys(names)))

    def _known(self, notes: list[Note]) -> "list[Exporter]":
        from hectorscope.exporters import exporters  # noqa: PLC0415

        replay = self._scene.replay
        return [*exporters(), *([replay(notes, self._source)] if replay else ())]


def _note(seconds: Any = None, words: Any = None) -> Note:
    said = _request.words(words, LONGEST)
    if not said:
        raise _request.BadRequest
    return Note(_request.number(seconds, 0.0, LAST_S), said)


def form_html(replay: bool) -> str:
    """Boxes for the formats, notes, and the buttons."""
    from hectorscope.exporters import exporters  # noqa: PLC0415

    names = [exporter.name for exporter in exporters()] + [REPLAY] * replay
    defaults = {exporter.name for exporter in exporters() if exporter.default}
    boxes = "".join(
        f'<label class="hs-own-box"><input type="checkbox" data-hs-format="{name}"'
        f"{' checked' if name in defaults else ''}>{text(TITLES.get(name, name))}</label>"
        for name in names
    )
    return FORM.replace("{boxes}", boxes)


_button = partial(_own.wide_button, "do")
FORM = (
    '<p class="hs-scope" title="Other browsers hear nothing of it.">This browser only</p>'
    '<div class="hs-own hs-export"><div class="hs-formats">{boxes}</div>'
    + _button("export", "Download the results so far", "Up to the shown scan, as one ZIP file.")
    + '<label class="hs-own-row"><span>Note</span><input type="text" maxlength="500" data-hs-note-text'
    ' aria-label="Note at the shown time" placeholder="what is seen at this time"></label>'
    + _button("note", "Pin the note to this time", "The replay shows it at the time that is shown now.")
    + '<ol data-hs-notes></ol><label class="hs-own-row"><span>Picture</span>'
    '<select aria-label="Size of the picture" data-hs-size><option value="">as it is here</option>'
    '<option value="1920x1080">1920 × 1080</option><option value="3840x2160">3840 × 2160</option>'
    '<option value="4000x4000">4000 × 4000</option></select></label>'
    + _button("picture", "Save a picture", "The scene as this browser shows it, as a PNG file.")
    + _button("video", "Record a video", "The scene as this browser shows it, until it is pressed again.")
    + "</div>"
)

PANEL = ExportPanel
