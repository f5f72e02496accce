"""Archives that the engine makes for a browser, beside the run."""

import io
import zipfile

from hectorscope.exporters import chosen
from hectorscope.session.commands import Export, Seek
from hectorscope.simulation import SceneOptions, Simulation
from tests.engines import after, running, until
from tests.sources import MemoryRecording, MemoryStream


def test_an_archive_holds_the_results_up_to_the_shown_scan() -> None:
    """The formats that read the recording once more end at the same scan, with the same figures, as the others."""
    drive = list(Simulation("rooms", SceneOptions(duration=5.0, scan_rate=10.0, beams=181)).items())
    with running(MemoryRecording(drive), speed=float("inf")) as engine:
        end = until(engine, lambda now: now.playback.state == "ended", 60.0)
        shown = after(engine, Seek(end.playback.start_ns + 3 * 10**9))
        engine.send(Export(7, tuple(chosen("tum,csv"))))
        done = until(engine, lambda now: 7 in now.downloads, 60.0)
    archive = zipfile.ZipFile(io.BytesIO(done.downloads[7].content))
    poses = archive.read("trajectory.tum").decode().splitlines()
    rows = archive.read("series.csv").decode().splitlines()[1:]
    assert 5 < len(poses) == len(rows) == shown.scans < end.scans
    stamps = [(line.split(" ")[0], row.split(",")[0]) for line, row in zip(poses, rows, strict=True)]
    assert all(a == b for a, b in stamps)
    places = [(line.split(" ")[1], row.split(",")[2]) for line, row in zip(poses, rows, strict=True)]
    assert all(abs(float(a) - float(b)) < 1e-6 for a, b in places)


def test_what_needs_a_recording_is_refused_for_a_stream() -> None:
    """And so is an export before the first scan; the log says why, and the run goes on."""
    drive = list(Simulation("rooms", SceneOptions(duration=3.0, scan_rate=5.0, beams=181)).items())
    stream = MemoryStream()
    with running(stream) as engine:
        engine.send(Export(1, tuple(chosen("tum"))))
        until(engine, lambda now: any("no scan has been used yet" in entry.text for entry in now.log))
        stream.send(drive)
        until(engine, lambda now: now.scans > 0, 60.0)
        engine.send(Export(1, tuple(chosen("csv"))))
        until(engine, lambda now: any("csv can" in entry.text for entry in now.log))
        engine.send(Export(1, tuple(chosen("tum"))))
        assert until(engine, lambda now: 1 in now.downloads, 60.0).downloads[1].name == "stream.zip"
