"""Streams in the engine: nothing waits, what is lost is counted."""

import time
from dataclasses import replace

import numpy as np
import pytest

from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.inputs import Item, SourceOptions
from hectorscope.session.commands import (
    Agree,
    ChangeSpeed,
    Configure,
    Pause,
    Play,
    Repair,
    Seek,
    SetSpeed,
    StepScan,
)
from hectorscope.session.feeder import Feeder
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import Imu, LaserScan
from tests.engines import PATIENCE_S, running, scan_times, state, until
from tests.sources import MemoryStream


def test_a_stream_whose_devices_lie_fails_with_the_remedy():
    """Ten seconds of a gyroscope in degrees: the page says what it is and which flag repairs it."""
    options = SceneOptions(duration=10.0, scan_rate=10.0, beams=181)
    stream = MemoryStream()
    stream.send(
        [
            replace(item, angular_velocity=np.degrees(item.angular_velocity)) if isinstance(item, Imu) else item
            for item in Simulation("rooms", options).items()
        ]
    )
    with running(CheckedSource(lambda _: stream, SourceOptions())) as engine:
        failed = until(engine, state("failed"))
    assert "so in degrees a second" in failed.playback.detail
    assert "--imu-gyro-unit deg/s" in failed.playback.detail


@pytest.mark.parametrize("repairs", [True, False])
def test_a_stream_is_repaired(drive: list[Item], repairs: bool):
    """By --repair or by the button the stream is opened again with what was found, and the map begins anew."""
    lying = [
        replace(item, linear_acceleration=item.linear_acceleration / 9.80665e-3) if isinstance(item, Imu) else item
        for item in drive
    ]
    opened: list[SourceOptions] = []

    def connect(options: SourceOptions) -> MemoryStream:
        opened.append(options)
        stream = MemoryStream()
        stream.send(lying if options.imu_accel_unit is None else drive)
        return stream

    with running(CheckedSource(connect, SourceOptions(), repairs=repairs)) as engine:
        if not repairs:
            failed = until(engine, state("failed"))
            assert [finding.repair for finding in failed.report.findings] == ["--imu-accel-unit mg"]
            engine.send(Repair())
        mended = until(engine, lambda now: now.report.repaired and now.scans > 5)
    assert [options.imu_accel_unit for options in opened] == [None, "mg"]
    assert any(entry.text.startswith("Repaired: ") for entry in mended.log)


def test_a_stream_gives_what_the_recording_gives(drive: list[Item], reference: np.ndarray):
    """Nothing dropped, same scans: the same trajectory to the last bit."""
    stream = MemoryStream()
    with running(stream) as engine:
        sent = 0
        for item in drive:
            stream.send([item])
            sent += isinstance(item, LaserScan)
            if sent and sent % 4 == 0 and isinstance(item, LaserScan):
                until(engine, lambda now, sent=sent: now.scans + sum(now.report.skipped.values()) >= sent - 4)
        last = len(reference) - 1
        now = until(engine, lambda now: now.scans >= last)
    assert now.report.dropped == 0
    assert now.playback.live
    assert now.playback.end_ns is None
    rows = slice(0, last)
    np.testing.assert_array_equal(now.trajectory[rows, 1:], reference[rows, 1:])


def test_a_slow_pipeline_loses_the_oldest_scans_and_no_inertial_data(drive: list[Item]):
    """While nobody takes anything, only old scans are given up, and they are counted."""
    stream = MemoryStream()
    stream.send(drive)
    stream.close()
    feeder = Feeder(stream)
    deadline = time.monotonic() + PATIENCE_S
    while feeder.reading and time.monotonic() < deadline:
        time.sleep(0.01)
    got = []
    while (item := feeder.get(0.0)) is not None:
        got.append(item)
    feeder.close()
    scans = [item for item in got if isinstance(item, LaserScan)]
    assert 0 < len(scans) < 20
    assert feeder.dropped == len(scan_times(drive)) - len(scans)
    assert [scan.stamp_ns for scan in scans] == scan_times(drive)[-len(scans) :]
    others = [item for item in drive if not isinstance(item, LaserScan)]
    assert [item for item in got if not isinstance(item, LaserScan)] == others


def test_a_paused_stream_flows_on(drive: list[Item]):
    """Scans that pass by during a pause are counted, but are no rate; play goes on with the newest."""
    stream = MemoryStream()
    half = len(drive) // 2
    with running(stream, autoplay=False) as engine:
        until(engine, state("paused"))
        stream.send(drive[:half])
        paused = until(engine, lambda now: now.report.skipped.get("scan while the stream was paused", 0) > 3)
        assert paused.scans == 0
        assert paused.playback.scan_rate == paused.playback.realtime_factor == 0.0
        engine.send(Play())
        stream.send(drive[half:])
        assert until(engine, lambda now: now.scans > 1).playback.state != "paused"


def test_a_stream_restarts_with_an_empty_map_and_cannot_seek(drive: list[Item]):
    """Restart keeps the stream and drops the map; a seek is refused in the log."""
    stream = MemoryStream()
    half = len(drive) // 2
    with running(stream) as engine:
        stream.send(drive[:half])
        until(engine, lambda now: now.scans > 1)
        engine.send(Seek(0))
        until(engine, lambda now: any("nothing was sought" in entry.text for entry in now.log))
        engine.send(Configure("map.levels", 2))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None
        engine.send(Agree(asked.number))
        until(engine, lambda now: now.epoch == 1)
        stream.send(drive[half:])
        fresh = until(engine, lambda now: now.scans > 1 and now.maps != ())
        assert fresh.epoch == 1
        assert len(fresh.maps) == 2
        assert any("new map" in entry.text for entry in fresh.log)


def test_a_stream_has_no_steps_and_no_speed(drive: list[Item]):
    """A full stop or a bracket, typed by mistake, neither stops it nor changes anything; who typed it is told."""
    stream = MemoryStream()
    with running(stream) as engine:
        stream.send(drive[: len(drive) // 2])
        until(engine, lambda now: now.scans > 1)
        for command in (StepScan(), SetSpeed(0.1), ChangeSpeed(-1)):
            engine.send(command)
        now = until(engine, lambda now: now.obeyed == engine.sent)
    assert now.playback.state != "paused"
    assert now.playback.speed == 1.0
    assert [entry.answer for entry in now.log if "its own pace" in entry.text] == [True] * 3


def test_a_silent_stream_is_waited_for(drive: list[Item]):
    """Nothing comes: the state says waiting, and the engine obeys."""
    with running(MemoryStream()) as engine:
        until(engine, state("waiting"))
        engine.send(Pause())
        until(engine, state("paused"))
