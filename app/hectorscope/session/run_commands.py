"""Carries out what a page asks of the runs: fork, show, rename, remove, keep, compare."""

from dataclasses import replace

from hectorscope.run.fingerprint import Identity
from hectorscope.run.metrics import truth_errors
from hectorscope.run.permalink import Permalink
from hectorscope.run.run_file import RunFile, hash_of
from hectorscope.run.settings import Settings
from hectorscope.session.commands import (
    ComparePaper,
    CompareRun,
    Fork,
    KeepRun,
    RemoveRun,
    RenameRun,
    RunCommand,
    ShowRun,
)
from hectorscope.session.following import Following
from hectorscope.session.library import Library
from hectorscope.session.runs import NamedRun, RunsError
from hectorscope.session.session import Session
from slam_core.config import preset

PAPER = "the paper"


class RunCommands:
    """Belongs to the engine's thread."""

    def __init__(self, session: Session, library: Library, following: Following) -> None:
        self._session, self._library, self._following = session, library, following

    def obey(self, command: RunCommand) -> None:
        """SlamError if it cannot be."""
        session = self._session
        if session.source.live or session.transport.empty:
            raise RunsError("There are runs of a recording only: a stream cannot be run again")
        session.named.note()
        match command:
            case Fork(name):
                self._fork(name)
            case ShowRun(number):
                self._show(number)
            case RenameRun(number, name):
                session.named.runs.rename(number, name)
            case RemoveRun(number):
                self._remove(number)
            case KeepRun():
                self._keep()
            case CompareRun(0):
                session.named.end_comparison()
            case CompareRun(number):
                session.named.compare(session.named.runs[number])
            case ComparePaper():
                self._compare_paper()

    def _compare_paper(self) -> None:
        """By a run of the list with its settings, which is made if there is none of this recording."""
        named, paper = self._session.named, Settings(preset("paper"))
        shown = named.runs[self._session.run.slot]
        run = named.runs.find(shown.path, paper) or named.runs.copied(replace(shown, settings=paper), PAPER)
        named.compare(run)
        named.runs.put(run)

    def _fork(self, name: str) -> None:
        session, runs = self._session, self._session.named.runs
        before = runs[session.run.slot]
        fork = runs.copied(before, name)
        runs.put(fork)
        session.run.slot = fork.number
        session.log(f"Forked: {before.name} stays as it is here, {fork.name} goes on")

    def _show(self, number: int) -> None:
        session = self._session
        run = session.named.runs[number]
        if number == session.run.slot:
            return
        if run.path is None:
            raise RunsError(f"{run.name} has no recording that could be run again: open one")
        identity = self._library.identities.find_out(run.path)
        if identity is None:
            raise RunsError(f"The recording of {run.name} can no longer be read: put it back, or remove the run")
        self._following.follow(self._link(identity, run, run.offset_ns), slot=number)

    def _remove(self, number: int) -> None:
        session = self._session
        if number == session.run.slot:
            raise RunsError("The run that is shown cannot be removed: show another one first")
        if session.named.compared_with == number:
            session.named.end_comparison()
        session.named.keep_removed(session.named.runs.remove(number))

    def _keep(self) -> None:
        """The shown run, in the folder for it."""
        session, pipeline = self._session, self._session.run.pipeline
        run = session.named.runs[session.run.slot]
        identity = self._library.identities.find_out(run.path) if run.path else None
        if identity is None or not pipeline.scans:
            raise RunsError("There is nothing to keep yet: wait for the first scan")
        errors = truth_errors(pipeline.trajectory, pipeline.truth) or {}
        kept = RunFile(
            link=self._link(identity, run, pipeline.time_ns - (pipeline.start_ns or 0)),
            recording=run.source,
            scans=pipeline.scans,
            trajectory_sha256=hash_of(pipeline.trajectory),
            sensors=session.source.report.sensors,
            figures={"map_updates": pipeline.slam.map.updates, **errors},
            annotations=session.run.annotations,
        )
        session.log(f"Kept {run.name} as {self._library.keep(kept)}", answer=True)

    def _link(self, recording: Identity, run: NamedRun, offset_ns: int) -> Permalink:
        return Permalink(recording, offset_ns, run.settings, run.name, self._session.map_sha256)
