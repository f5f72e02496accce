"""Records the scene of a run with the views of the page, and puts a page of ours around viser's own player."""

import html
import json
import secrets
from base64 import b64encode
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hectorscope.common.resources import resource_folder
from hectorscope.exporters import REPLAY, GrowingFile
from hectorscope.page import viser_private
from hectorscope.page.ellipse_scale import fitted
from hectorscope.page.marks import layers_mark, levels_mark
from hectorscope.page.scene import Scene
from hectorscope.panels.plots import charts_json, series_rows
from hectorscope.run.map_image import MapImage
from hectorscope.run.map_images import map_images
from hectorscope.run.notes import Note
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.publisher import change_of_tracking
from hectorscope.session.snapshot import LogEntry, Snapshot
from hectorscope.views import view_classes
from hectorscope.web.access_control import AccessControl
from hectorscope.web.address import listen
from hectorscope.web.guarded_server import open_server, stop_server
from hectorscope.web.server import made
from slam_core.results import StepResult

FRAME_S, MAP_S = 0.1, 0.5  # between pictures of the scan, and of the map
DENSE_S = 60.0  # from then on they get sparser as the time grows, so that an hour takes five times a minute
CHARTS = ("Match", "Covariance")
SCRIPTS = ("browser.js", "charts.js", "dress.js", "levels.js", "scene.js", "shared/replay.js")
STYLES = ("palette.css", "shared/replay.css")
FRESH = 'localStorage.removeItem("hectorscope");'  # files share a storage: each begins with the author's view


class ReplayStream:
    """The file that `Exporter.stream` promises: all of it is written at the end of the run."""

    def __init__(self, folder: Path, notes: Sequence[Note], source: str) -> None:
        self._file = GrowingFile(folder / REPLAY)
        self._notes, self._source = notes, source
        # A viewer's server that nobody can enter: its messages are recorded, not sent.
        self._server = open_server(listen("127.0.0.1", 0), AccessControl({}, secrets.token_urlsafe()))
        self._scene = Scene(self._server, lambda _: None)
        with viser_private.icons_at_hand():
            self._views = made(view_classes(), self._scene)
        self._serializer = self._server.get_scene_serializer()
        self._maps: tuple[MapImage, ...] = ()
        self._frame_s = self._map_s = -np.inf
        self._time_s = 0.0
        self._before: StepResult | None = None
        self._log: list[LogEntry] = []

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """A picture, if it is time for one, and a line of the log."""
        time_s = self._seconds(pipeline, result.stamp_ns)
        if change := change_of_tracking(self._before, result):
            self._log.append(LogEntry(result.stamp_ns, *change, pipeline.scans))
        self._before = result
        sparser = max(1.0, time_s / DENSE_S)
        if time_s - self._frame_s >= FRAME_S * sparser - 1e-3:
            self._draw(pipeline, time_s, anew=time_s - self._map_s >= MAP_S * sparser - 1e-3)

    def finish(self, pipeline: Pipeline) -> None:
        """The last picture, and the file."""
        if pipeline.result is not None:
            self._draw(pipeline, self._seconds(pipeline, pipeline.result.stamp_ns), anew=True)
        recorded = self._serializer.as_html(dark_mode=True)
        self._file.write(around(recorded, self._marks(), self._described(pipeline)).encode())
        self._file.finish()
        stop_server(self._server)

    def close(self) -> None:
        """Let go of the file and the server, finished or not."""
        self._file.close()
        stop_server(self._server)

    def _seconds(self, pipeline: Pipeline, stamp_ns: int) -> float:
        return (stamp_ns - (pipeline.start_ns or 0)) / 1e9

    def _draw(self, pipeline: Pipeline, time_s: float, *, anew: bool) -> None:
        if anew:
            self._maps = map_images(pipeline.slam.map, pipeline.scans)
            self._map_s = time_s
        self._frame_s = time_s
        self._serializer.insert_sleep(max(0.0, time_s - self._time_s))
        self._time_s = max(time_s, self._time_s)
        snapshot = seen(pipeline, self._maps)
        self._scene.show(ellipse_scale=fitted(snapshot, self._scene.display.ellipse_scale))
        for view in self._views:
            view.draw(snapshot)

    def _marks(self) -> str:
        """What the scripts of the page read of layers, levels and charts."""
        layers = [(layer, "") for layer in self._scene.layers if not layer.on_demand]
        levels = levels_mark([image.resolution for image in self._maps])
        charts = f'<i class="hs-mark" data-hs-charts="{html.escape(charts_json())}"></i>'
        return layers_mark(layers) + levels + charts

    def _described(self, pipeline: Pipeline) -> dict[str, Any]:
        """Everything about the run but the scene."""
        start_ns = pipeline.start_ns or 0
        changes = (LogEntry(c.time_ns, f"{c.name} is {c.value} from here on") for c in pipeline.settings.changes)
        warned = (LogEntry(time_ns, text, "warning", n) for text, (time_ns, n) in pipeline.warned.items())
        log = sorted([*self._log, *changes, *warned], key=lambda entry: entry.time_ns)
        rows = series_rows(seen(pipeline, ()).series, 0)
        return {
            "source": self._source,
            "span": self._time_s,
            "pages": CHARTS,
            "series": b64encode(rows.astype("<f4").tobytes()).decode(),
            "log": [[(entry.time_ns - start_ns) / 1e9, entry.level, entry.text] for entry in log],
            "notes": [[note.seconds, note.text] for note in sorted(self._notes, key=lambda note: note.seconds)],
        }


def seen(pipeline: Pipeline, maps: tuple[MapImage, ...]) -> Snapshot:
    """A snapshot as the views need it."""
    return Snapshot(
        sequence=pipeline.scans,
        config=pipeline.slam.config,
        result=pipeline.result,
        trajectory=pipeline.trajectory,
        truth=pipeline.truth,
        truth_in_map=pipeline.truth_in_map,
        series=pipeline.series.view(SERIES_DTYPE).reshape(-1),
        maps=maps,
        map_updates=pipeline.slam.map.updates,
        scans=pipeline.scans,
    )


def around(recorded: str, marks: str, described: dict[str, Any]) -> str:
    """The page of viser's player with our style, scripts and data in it; text of others cannot end a script."""
    data = json.dumps(described).replace("<", "\\u003c")
    head = f"<style>{_joined(STYLES)}</style><script>{FRESH}window.hectorscopeReplay = {data};</script>"
    body = marks + "".join(f"<script>{text}</script>" for text in _texts(SCRIPTS))
    recorded = recorded.replace("<title>Viser</title>", "<title>Hectorscope replay</title>", 1)
    top, bottom = recorded.index("</head>"), recorded.rindex("</body>")
    return recorded[:top] + head + recorded[top:bottom] + body + recorded[bottom:]


def _joined(names: Iterable[str]) -> str:
    return "\n".join(_texts(names))


def _texts(names: Iterable[str]) -> list[str]:
    folder = resource_folder("static")
    return [(folder / name).read_text(encoding="utf-8") for name in names]
