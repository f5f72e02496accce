"""What the plots send to the browsers."""

import base64
import json
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from pytest import MonkeyPatch

from hectorscope.page.scene import Scene
from hectorscope.panels import plots
from hectorscope.panels._curves import COLUMNS, PAGES, TIME
from hectorscope.panels._truth_error import truth_error
from hectorscope.panels.plots import BATCH, PlotsPanel, charts_json, error_rows, series_rows
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.snapshot import Snapshot
from tests.page import room_snapshot, with_series

SCRIPT = re.compile(r"window\.hectorscope\?\.rows\?\.\('(\w+)', (\d+), '([^']*)'\)")


class Browser:
    """Puts together what it is sent, as static/plots.js does."""

    def __init__(self, client: int) -> None:
        self.client, self.received = client, 0
        self.tables: dict[str, np.ndarray] = {}

    def take(self, panel: PlotsPanel, snapshot: Snapshot) -> None:
        """Add the rows that the panel has for this browser."""
        for script in panel.news(self.client, snapshot):
            match = SCRIPT.fullmatch(script)
            assert match is not None
            table, first, content = match.groups()
            width = json.loads(charts_json())["widths"][table]
            news = np.frombuffer(base64.b64decode(content), "<f4").reshape(-1, width)
            before = self.tables.get(table, np.empty((0, width), np.float32))
            self.tables[table] = np.concatenate([before[: int(first)], news])
            self.received += len(news)


def run_of(rows: int, lineage: int = 0) -> Snapshot:
    """A run of so many scans, whose columns are all different."""
    series = np.zeros(rows, SERIES_DTYPE)
    for i, name in enumerate(SERIES_DTYPE.names or ()):
        series[name] = i + np.arange(rows)
    series[TIME] = 0.1 * np.arange(rows)
    return with_series(replace(room_snapshot(), truth=np.empty((0, 8))), series, lineage)


def test_every_row_is_sent_once(scene: Scene) -> None:
    """Each browser gets what it has not: one who joins the whole run in batches, a run begun again anew."""
    panel, one, two = PlotsPanel(scene), Browser(1), Browser(2)
    for rows in (10, 10, 25):
        one.take(panel, run_of(rows))
    assert one.received == 25
    whole = run_of(2 * BATCH + 70)
    for _ in range(3):
        two.take(panel, whole)
    one.take(panel, whole)
    np.testing.assert_array_equal(two.tables["series"], series_rows(whole.ahead.series, 0))
    np.testing.assert_array_equal(one.tables["series"], series_rows(whole.ahead.series, 0)[: 25 + BATCH])
    one.take(panel, run_of(5, lineage=1))
    assert len(one.tables["series"]) == 5


def test_a_page_that_asks_while_rows_are_sent_gets_all_of_them(scene: Scene, monkeypatch: MonkeyPatch) -> None:
    """It asks again because what was sent before may be lost."""
    panel, before, after = PlotsPanel(scene), Browser(1), Browser(1)
    before.take(panel, run_of(20))

    def asked_meanwhile(series: np.ndarray, first: int) -> np.ndarray:
        panel._begin(cast(Any, SimpleNamespace(client=SimpleNamespace(client_id=1))))
        return series_rows(series, first)

    with monkeypatch.context() as patched:
        patched.setattr(plots, "series_rows", asked_meanwhile)
        before.take(panel, run_of(30))
    after.take(panel, run_of(30))
    assert len(after.tables["series"]) == 30


def test_rows_that_are_known_are_sent_before_they_are_shown(scene: Scene) -> None:
    """A jump back sends nothing again: the page draws fewer of the rows that it has."""
    panel, page, known = PlotsPanel(scene), Browser(1), run_of(30)
    for shown in (0, 20, 5, 25):
        page.take(panel, replace(known, series=known.series[:shown], epoch=shown))
    assert page.received == 30


def test_charts_name_their_columns() -> None:
    """What the page reads at the place of a curve is the column of that curve."""
    described = json.loads(charts_json())
    assert list(described["pages"]) == list(PAGES)
    rows = series_rows(run_of(3).ahead.series, 0)
    for page, charts in PAGES.items():
        for chart, sent in zip(charts, described["pages"][page], strict=True):
            assert (sent["title"], sent["factor"]) == (chart.title, chart.factor)
            for curve, told in zip(chart.curves, sent["curves"], strict=True):
                if sent["table"] == "series":
                    np.testing.assert_array_equal(rows[:, told["column"]], run_of(3).series[curve.column])
    assert COLUMNS[0] == TIME


def test_the_error_against_the_truth_is_a_curve() -> None:
    """In the plane, in heading and in height, where the truth covers the run; without one there are no rows."""
    snapshot = room_snapshot()
    half = np.radians(1.0)
    truth = snapshot.truth.copy()
    truth[10:, 1] += 0.03
    truth[10:, 2] += 0.04
    truth[:, 4], truth[:, 7] = np.cos(half), np.sin(half)
    covered = replace(snapshot, truth=truth[:30], truth_in_map=np.zeros(4))
    rows = truth_error(covered)
    there = snapshot.truth[:30, 1:3] - snapshot.trajectory[:30, 1:3]
    np.testing.assert_allclose(rows["error"][:10], np.hypot(*there[:10].T), atol=1e-12)
    there[10:] += [0.03, 0.04]
    np.testing.assert_allclose(rows["error"][10:30], np.hypot(*there[10:].T), atol=1e-12)
    np.testing.assert_allclose(rows["error_yaw"][:30], -2.0 * half)
    assert np.isnan(rows["error"][30:]).all()
    assert np.isnan(rows["error_z"]).all()
    assert len(error_rows(covered, 0)) == 30
    np.testing.assert_array_equal(error_rows(covered, 12), error_rows(covered, 0)[12:])
    assert len(error_rows(replace(snapshot, truth=np.empty((0, 8))), 0)) == 0
