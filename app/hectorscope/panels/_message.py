"""What somebody has to know before anything else: one message over the scene, in large type."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

from hectorscope.panels._format import sentence
from hectorscope.run.wording import verdict_text
from hectorscope.session.snapshot import Snapshot

Kind = Literal["error", "warning", "busy"]
CONFIRMING = "A pose was found again; further scans have to confirm it."
SYMBOLS: dict[Kind, str] = {"error": "✕", "warning": "!", "busy": "…"}


class Message(NamedTuple):
    """title: what is the matter. detail: why, and what to do. The kind has a symbol: colour is not needed."""

    kind: Kind
    title: str
    detail: str = ""


def message(snapshot: Snapshot) -> Message | None:
    """The most urgent one; None while all is well."""
    told = next(_messages(snapshot), None)
    return told and told._replace(detail=sentence(told.detail))


def _messages(snapshot: Snapshot) -> Iterator[Message]:
    playback = snapshot.playback
    if playback.state == "failed" and not snapshot.report.findings:  # else their card says it all
        yield Message("error", "The run has stopped", playback.detail)
    if playback.state == "loading" and playback.detail and playback.detail != snapshot.report.waiting:
        yield Message("busy", "Getting ready", playback.detail)
    if playback.live:
        yield from _of_stream(snapshot)
    if playback.state == "seeking" and playback.detail:
        yield Message("busy", "Please wait", playback.detail)
    yield from _of_pose(snapshot)
    if playback.live and playback.state == "playing" and playback.detail and playback.lag is None:
        yield Message("busy", "Please wait", playback.detail)


def _of_stream(snapshot: Snapshot) -> Iterator[Message]:
    """What keeps a stream from being mapped: the link, the laser, a pause."""
    playback, report = snapshot.playback, snapshot.report
    awaited = report.scan_topic or "the laser"
    if report.connected is False:
        title = "Connection to the robot lost" if snapshot.scans else "No connection to the robot"
        yield Message("error", title, report.waiting)
    elif report.waiting:
        yield Message("error", "No laser on this robot yet", report.waiting)
    elif playback.state == "paused" and playback.lag is None:
        yield Message("warning", "Paused", "The scans of the robot go by unused; press play to go on.")
    elif playback.state == "waiting" and snapshot.scans:
        yield Message("error", "No scans from the robot", f"The link is there, but nothing comes from {awaited}.")
    elif playback.state == "waiting":
        detail = f"The robot is connected, but nothing comes from {awaited}."
        yield Message("warning", "Waiting for the first scan", detail)
    elif playback.state == "loading" and report.skipped and not snapshot.scans:
        reason = max(report.skipped.items(), key=lambda item: item[1])[0]
        yield Message("warning", "Waiting for the first scan that can be used", reason)


def _of_pose(snapshot: Snapshot) -> Iterator[Message]:
    """Whether it is known where the robot is."""
    result = snapshot.result
    if snapshot.searching:
        yield Message("warning", "The robot is not found in the map yet", snapshot.searching)
    if result is not None and result.tracking == "lost":
        yield Message("error", "Tracking lost", verdict_text(result.verdict) or CONFIRMING)
