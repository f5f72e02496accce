"""What a snapshot is composed of: the session, what it can open, and what waits for an answer."""

from hectorscope.run.fingerprint import Identity
from hectorscope.session.control import Control
from hectorscope.session.library import Library
from hectorscope.session.publisher import Run
from hectorscope.session.session import Session
from hectorscope.session.snapshot import ListedRun
from hectorscope.session.station_state import StationState


def composed(session: Session, library: Library, control: Control, obeyed: int, station: StationState) -> Run:
    """By the engine's thread."""
    shown, comparison, ahead = session.shown_intake, session.named.comparison, session.newest.ahead
    return Run(
        source=session.source,
        pipeline=session.run.pipeline,
        transport=session.transport,
        config=session.run.settings.at(session.now_ns),
        report=session.report,
        epoch=session.epoch,
        saves=control.background.saver.out is not None,
        obeyed=obeyed,
        station=station,
        question=control.questions.open,
        undo=session.undone.offer,
        ahead=ahead,
        behind=session.intake.behind,
        lag=session.lag,
        kept_ns=session.kept_ns,
        library=library.listed,
        recording=_recording(session, library),
        map_sha256=session.map_sha256,
        runs=_runs(session),
        shown_run=session.run.slot,
        keeps=library.kept.folder is not None,
        views=control.probes.views(session.run),
        examined=control.background.examiner.found(session.source),
        downloads=control.background.downloads.ready,
        drive=shown.drivable.state if shown.drivable else None,
        rework=session.run.rework,
        other_scans=session.run.other_scans(shown.rereadable, ahead.series["time_s"]),
        compared=comparison.state(session.run.pipeline) if comparison else None,
    )


def _runs(session: Session) -> tuple[ListedRun, ...]:
    """Those of the list; the shown one as it is now, unless nothing is open, or a stream is."""
    if session.run.pipeline.scans and not session.source.live:
        session.named.note()
    return session.named.runs.listed()


def _recording(session: Session, library: Library) -> Identity | None:
    """What is shown, by its content: it is read for that once the run goes, and not before."""
    path, begun = session.intake.path, session.run.pipeline.scans
    return library.identities.known(path) if path and begun else None
