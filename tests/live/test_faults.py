"""Faults of the robot, the link and the browsers: the run stays true, everything is counted, nothing raises."""

from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest

from benchmarks.faults import AHEAD_S, LAST_S, Outcome, clock_off, killed, scans_skipped, scrambled, too_many
from hectorscope.inputs import SourceReport
from hectorscope.page.viser_private import unsent
from hectorscope.panels import plots
from hectorscope.panels.plots import PlotsPanel
from hectorscope.panels.status import losses_html
from hectorscope.run.warmup import load_everything
from hectorscope.web.heartbeat import MOST_UNSENT
from hectorscope.web.server import PageServer
from tests.live.browsers import Client
from tests.live.measurements import wait_for
from tests.live.relay import SCAN
from tests.page import StillEngine, room_snapshot

SECONDS = 6.0
TRUE_M = 0.03  # of the last pose
ALIGNING_S = 1.0  # in which no scan can be used
MEBIBYTE = 2**20


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """For the drives. Kernels that are compiled while a robot speaks cost scans."""
    load_everything()
    return tmp_path_factory.mktemp("drives")


def check(run: Outcome) -> None:
    """The last pose is true and late, every scan that came is accounted for, and the log has no error."""
    assert run.error_m < TRUE_M
    assert run.covered_s > SECONDS - ALIGNING_S - LAST_S
    assert run.used + run.dropped + scans_skipped(run.skipped) == run.read[SCAN]
    assert not run.failures


def test_lost_doubled_and_late_messages(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A tenth each: what came is counted by topic, what came late is skipped with its reason."""
    run = scrambled(folder, SECONDS)
    check(run)
    assert run.read == run.given
    assert any("/imu/data_raw: time runs backwards" in why for why in run.skipped)
    assert not caplog.records


def test_a_clock_that_is_off_and_drifts(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """An hour ahead, it is told within the second, costs no message, and leaves the run as it is."""
    run = clock_off(folder, SECONDS)
    check(run)
    assert run.read == run.given
    assert not any(why.startswith("/") for why in run.skipped)
    assert run.clock_s == pytest.approx(AHEAD_S, abs=1.0)
    assert not caplog.records


def test_more_scans_than_can_be_processed(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Scans are dropped, counted and shown; the newest is used, and all inertial data arrives."""
    run = too_many(folder, SECONDS)
    check(run)
    assert run.dropped > 0
    assert run.read == run.given
    assert f">{run.dropped}<" in losses_html(SourceReport(dropped=run.dropped), {})
    assert not caplog.records


@pytest.mark.slow
def test_a_server_that_is_killed_ten_times(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Each time the run goes on with its map once the next one listens."""
    check(killed(folder, SECONDS))
    assert not caplog.records


class Page:
    """A page that stands still, with a browser that never reads and one that does."""

    def __init__(self) -> None:
        self.server = PageServer(StillEngine(room_snapshot()), port=0)
        self.server.start()
        port = int(self.server.url.rsplit(":", 1)[1].strip("/"))
        self.idle, self.reading = Client(port, None), Client(port)
        wait_for(lambda: len(self.clients) == 2)
        self.first, self.second = self.clients.values()
        self._noise = Random(1)

    @property
    def clients(self) -> dict[int, Any]:
        """As the server has them."""
        return self.server._server.get_clients()

    def send(self) -> None:
        """A mebibyte to both, once the second one has read all; viser packs what repeats."""
        self.server.scene.run(f"/*{self._noise.randbytes(MEBIBYTE // 2).hex()}*/")
        wait_for(lambda: unsent(self.second) == 0)


@pytest.fixture
def page() -> Iterator[Page]:
    """Ended in any case."""
    made = Page()
    try:
        yield made
    finally:
        made.idle.close()
        made.reading.close()
        made.server.stop()


def test_a_browser_that_stops_reading_is_let_go(page: Page) -> None:
    """No more than so much waits for it; other browsers hear all, and the server goes on."""
    most = 0
    while most <= MOST_UNSENT and len(page.clients) == 2:
        page.send()
        most = max(most, unsent(page.first))
    wait_for(lambda: len(page.clients) == 1)
    assert list(page.clients.values()) == [page.second]
    # It may be let go before what the last mebibyte made of it was seen here.
    assert MOST_UNSENT - MEBIBYTE < most < MOST_UNSENT + 2 * MEBIBYTE
    before = page.reading.received
    wait_for(lambda: page.reading.received > before)  # the heartbeat goes on
    assert not page.reading.ended.is_set()


def test_curves_wait_for_a_browser_that_does_not_read(page: Page) -> None:
    """Both ask for them; who reads has every row, and nothing more is put behind what waits for the other."""
    (panel,) = (item.draw.__self__ for item in page.server._renderer._items if item.title == PlotsPanel.title)
    while unsent(page.first) <= 8 * plots.MOST_UNSENT:  # of which the sockets between may still take some
        page.send()
    for client in (page.first, page.second):
        panel._sent[client.client_id] = {}  # as the button of its page does
    rows = len(room_snapshot().series)
    wait_for(lambda: panel._sent[page.second.client_id].get("series", (0, 0))[1] == rows)
    wait_for(lambda: unsent(page.second) == 0)
    assert panel._sent[page.first.client_id] == {}
