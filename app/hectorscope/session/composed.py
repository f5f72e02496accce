"""Composes a snapshot of the session, what it can open, and what waits for an answer."""

from hectorscope.run.fingerprint import Identity
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.control import Control
from hectorscope.session.library import Library
from hectorscope.session.session import Session
from hectorscope.session.snapshot import ListedRun, PlaybackStatus, Snapshot
from hectorscope.session.station_state import StationState


def composed(session: Session, library: Library, control: Control, obeyed: int, station: StationState) -> Snapshot:
    """All but the number, the map images and the log, which the publisher adds. By the engine's thread."""
    shown, comparison, ahead = session.shown_intake, session.named.comparison, session.past.newest.ahead
    pipeline, report = session.run.pipeline, session.report
    return Snapshot(
        epoch=session.epoch,
        source=session.source.name,
        playback=_playback(session, report.waiting),
        config=session.run.settings.at(session.now_ns),
        result=pipeline.result,
        trajectory=pipeline.trajectory,
        navigation=pipeline.navigation,
        truth=pipeline.truth,
        truth_in_map=pipeline.truth_in_map,
        series=pipeline.series.view(SERIES_DTYPE).reshape(-1),
        map_updates=pipeline.slam.map.updates,
        scans=pipeline.scans,
        report=report,
        mode=pipeline.mode,
        searching=pipeline.searching,
        warnings=(*report.warnings, *pipeline.warnings()),
        unused=dict(pipeline.slam.status.unused),
        saves=control.background.saver.out is not None,
        obeyed=obeyed,
        question=control.questions.open,
        undo=session.undone.offer,
        library=library.listed,
        recording=_recording(session, library),
        map_sha256=session.map_sha256,
        runs=_runs(session),
        shown_run=session.run.slot,
        keeps=library.kept.folder is not None,
        compared=comparison.state(pipeline) if comparison else None,
        ahead=ahead,
        views=control.probes.views(session.run),
        examined=control.background.examiner.found(session.source),
        downloads=control.background.downloads.ready,
        station=station,
        drive=shown.drivable.state if shown.drivable else None,
        rework=session.run.rework,
        other_scans=session.run.other_scans(shown.rereadable, ahead.series["time_s"]),
    )


def _playback(session: Session, waiting: str) -> PlaybackStatus:
    """Where the run is. waiting: what the source waits for."""
    pipeline, transport, span_ns = session.run.pipeline, session.transport, session.source.span_ns
    return PlaybackStatus(
        state=transport.state(pipeline.scans),
        live=session.source.live,
        time_ns=pipeline.time_ns,
        start_ns=pipeline.start_ns or 0,
        end_ns=span_ns[1] if span_ns else None,
        speed=transport.speed,
        realtime_factor=transport.meter.realtime_factor,
        scan_rate=transport.meter.scan_rate,
        detail=_detail(session, waiting),
        kept_ns=session.past.kept_ns,
        lag=session.past.lag,
        seeks=transport.seeks,
        preparing=transport.preparing,
        prepared=transport.prepared,
    )


def _detail(session: Session, waiting: str) -> str:
    """The same in words, as far as the state does not tell it."""
    pipeline, transport = session.run.pipeline, session.transport
    if transport.target_ns is not None:
        start_ns = pipeline.start_ns or 0
        whole_ns = max(1, transport.target_ns - start_ns)
        return f"running up to {whole_ns / 1e9:.1f} s: {100 * (pipeline.time_ns - start_ns) // whole_ns} %"
    if session.past.lag is not None:
        return f"behind by {session.past.lag:.0f} s"
    behind = session.intake.behind
    catching_up = f"catching up with the stream: {behind} scans behind" if behind else ""
    again = "scan processed again" if transport.processed_again else ""
    return transport.opening or transport.failure or waiting or catching_up or again


def _runs(session: Session) -> tuple[ListedRun, ...]:
    """Those of the list; the shown one as it is now, unless nothing is open, or a stream is."""
    if session.run.pipeline.scans and not session.source.live:
        session.named.note()
    return session.named.runs.listed()


def _recording(session: Session, library: Library) -> Identity | None:
    """What is shown, by its content: it is read for that once the run goes, and not before."""
    path, begun = session.intake.path, session.run.pipeline.scans
    return library.identities.known(path) if path and begun else None
