"""Curves over time: every row of figures is sent to each browser once; static/plots.js draws those shown.

Each browser chooses its charts and their window. viser's own charts know neither: what they show, and how high,
all browsers share, and each update sends them whole (19 KB for three charts of 300 points; a row of all is 150
bytes).
"""

import html
import json
from base64 import b64encode
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray
from viser import GuiButtonHandle, GuiEvent

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels._compared import APART_COLUMNS, ERRORS_COLUMNS, MAPS_COLUMNS, apart_rows, errors_rows
from hectorscope.panels._curves import COLUMNS, PAGES, TIME
from hectorscope.panels._truth_error import ERROR_COLUMNS, truth_error
from hectorscope.session.snapshot import Snapshot

COMPARED_TABLES = {"apart": APART_COLUMNS, "errors": ERRORS_COLUMNS, "maps": MAPS_COLUMNS}
MOST_UNSENT = 2**20  # characters that wait for a browser
BATCH = 4000  # rows sent at once: one who joins a long run gets them over some seconds
Table = NDArray[np.float32]
Sent = dict[str, tuple[object, int]]  # of each table the run, and the rows of it


class PlotsPanel:
    """Sends what each browser does not have yet."""

    title = "Plots"
    order = 40
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sent: dict[int, Sent] = {}  # by client
        gui = scene.server.gui
        ask = gui.add_button("Send the curves", visible=False)
        ask.on_click(self._begin)
        uuid = viser_private.uuid_of(ask)
        scene.for_viewers.add(uuid)
        gui.add_html(f'<i class="hs-mark" data-hs-charts="{html.escape(charts_json())}" data-hs-ask="{uuid}"></i>')

    def _begin(self, event: GuiEvent[GuiButtonHandle]) -> None:
        """A page is ready: it gets all rows, as those sent before may be lost."""
        if event.client is not None:
            self._sent[event.client.client_id] = {}

    def draw(self, snapshot: Snapshot) -> None:
        """Send new rows to every browser that has asked."""
        clients = self._scene.server.get_clients()
        for key in list(self._sent):
            if key not in clients:
                del self._sent[key]
                continue
            if viser_private.unsent(clients[key]) > MOST_UNSENT:
                continue  # it gets them once it has read what was sent
            for script in self.news(key, snapshot):
                self._scene.run(script, clients[key])

    def news(self, client: int, snapshot: Snapshot) -> list[str]:
        """The scripts that give this browser the rows that it does not have yet, at most BATCH of each table."""
        sent = self._sent.setdefault(client, {})  # if the page asks now, it gets another one, and all rows
        known = snapshot.ahead.lineage
        truth = (known, *snapshot.truth_in_map)
        scripts = [
            added(sent, "series", known, lambda first: series_rows(snapshot.ahead.series, first)),
            added(sent, "truth", truth, lambda first: error_rows(snapshot, first)),
        ]
        both = (known, snapshot.compared.number if snapshot.compared else 0)
        for table, rows in compared_tables(snapshot).items():
            begun = rows(0)[:1].tobytes() if table == "maps" else b""  # after a jump back they begin anew
            scripts.append(added(sent, table, (both, begun), rows))
        return [script for script in scripts if script]


def added(sent: Sent, table: str, run: object, rows: Callable[[int], Table]) -> str:
    """The script that adds the rows after those sent; of another run all from the first. Empty without any."""
    before, first = sent.get(table, (None, 0))
    first = first if before == run else 0
    new = rows(first)[:BATCH]
    if before == run and not len(new):
        return ""
    sent[table] = run, first + len(new)
    return f"window.hectorscope?.rows?.('{table}', {first}, '{b64encode(new.astype('<f4').tobytes()).decode()}')"


def series_rows(series: NDArray[np.void], first: int) -> Table:
    """(n, columns) of the rows from `first` on, in the order of COLUMNS."""
    rows = series[first:]
    return np.stack([rows[name] for name in COLUMNS], axis=1).astype(np.float32)


def error_rows(snapshot: Snapshot, first: int) -> Table:
    """(n, columns) of the errors from pose `first` on as far as the truth covers them, as in ERROR_COLUMNS."""
    rows = truth_error(snapshot, first)
    known = np.flatnonzero(np.isfinite(rows["error"]))
    rows = rows[: known[-1] + 1 if len(known) else 0]
    return np.stack([rows[name] for name in ERROR_COLUMNS], axis=1).astype(np.float32)


def compared_tables(snapshot: Snapshot) -> dict[str, Callable[[int], Table]]:
    """Of each table of the compared run what gives its rows from one on; of none, without one."""
    compared = snapshot.compared
    if compared is None:
        return {name: partial(_no_rows, len(columns)) for name, columns in COMPARED_TABLES.items()}
    return {
        "apart": lambda first: apart_rows(snapshot, compared, first).astype(np.float32),
        "errors": lambda first: errors_rows(snapshot, compared, first).astype(np.float32),
        "maps": lambda first: compared.map_apart[first:].astype(np.float32),
    }


def _no_rows(width: int, _first: int) -> Table:
    return np.empty((0, width), np.float32)


def charts_json() -> str:
    """The charts of every page, with the tables and columns that their curves are in."""
    tables = {"series": COLUMNS, "truth": ERROR_COLUMNS, **COMPARED_TABLES}
    places = {name: (table, i) for table, names in tables.items() for i, name in enumerate(names) if name != TIME}
    pages = {
        page: [
            {
                "title": chart.title,
                "factor": chart.factor,
                "log": chart.log,
                "angles": chart.angles,
                "table": places[chart.curves[0].column][0],
                "curves": [
                    {"name": c.name, "colour": c.colour, "column": places[c.column][1]} for c in chart.curves
                ],
            }
            for chart in charts
        ]
        for page, charts in PAGES.items()
    }
    return json.dumps({"widths": {table: len(names) for table, names in tables.items()}, "pages": pages})


PANEL = PlotsPanel
