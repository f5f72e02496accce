"""What fails under the engine is named, and the engine survives it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from hectorscope.inputs import Item
from hectorscope.session.commands import Restart
from hectorscope.session.journal import Journal
from hectorscope.session.journal_files import CLOSED
from hectorscope.session.station import Station
from slam_core.measurements import Imu, LaserScan
from tests.engines import running, state, until
from tests.sources import MemoryRecording, MemoryStream


def test_a_failing_source_is_named_and_the_engine_survives(drive: list[Item], reference: np.ndarray):
    """What was read is processed and shown with the reason; a restart reads again."""
    source = MemoryRecording(drive, error=OSError("the disk is gone"), fail_at=len(drive) // 2)
    with running(source, speed=math.inf) as engine:
        failed = until(engine, state("failed"))
        assert "memory" in failed.playback.detail
        assert "the disk is gone" in failed.playback.detail
        assert 0 < failed.scans < len(reference)
        assert failed.log[-1].level == "error"
        engine.send(Restart())
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()


def test_an_error_in_the_core_does_not_end_the_engine(drive: list[Item]):
    """A measurement that the core chokes on is reported; the engine still obeys."""
    broken = LaserScan(drive[0].stamp_ns, None, 0.0, 0.1)  # type: ignore[arg-type]
    with running(MemoryRecording([broken, *drive]), speed=math.inf) as engine:
        failed = until(engine, state("failed"))
        assert "TypeError" in failed.playback.detail
        engine.send(Restart())
        until(engine, lambda now: now.epoch == 1 and now.playback.state == "failed")


def test_a_recording_without_a_usable_scan_says_so(drive: list[Item]):
    """An empty outcome is a failure with its reason, not a silent end."""
    no_scans = [item for item in drive if not isinstance(item, LaserScan)]
    with running(MemoryRecording(no_scans), speed=math.inf) as engine:
        failed = until(engine, state("failed"))
    assert "memory: no scan could be used" in failed.playback.detail


def test_an_imu_that_tells_no_attitude_is_named_with_the_remedy(drive: list[Item]):
    """Scans wait for it in vain for as long as that recording lasts; without it they could be used."""
    frozen = [
        replace(item, stamp_ns=drive[0].stamp_ns) if isinstance(item, Imu) else item
        for item in drive
        if item.stamp_ns - drive[0].stamp_ns < 2e9
    ]
    with running(MemoryRecording(frozen), speed=math.inf) as engine:
        failed = until(engine, state("failed"))
    assert "x inertial sample not later than the one before" in failed.playback.detail
    assert "leave it out by --imu-topic none" in failed.playback.detail


class StuckStream(MemoryStream):
    """It cannot be closed in order."""

    def close(self) -> None:
        """It ends all the same."""
        super().close()
        raise OSError("the connection is gone")


def test_a_source_that_fails_at_its_end_leaves_a_journal_that_is_closed(tmp_path: Path):
    """The next start does not offer the run as one that was cut off."""
    journal = Journal(tmp_path, "a", MemoryRecording)  # type: ignore[arg-type]
    with running(StuckStream(), station=Station(journal=journal)) as engine:
        until(engine, lambda now: now.playback.live)
    assert (journal.folder / CLOSED).exists()
