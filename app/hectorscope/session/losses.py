"""What a command would take away from everybody who watches a stream, in words for the question that is asked."""

from collections.abc import Callable
from dataclasses import dataclass

from hectorscope.run.pipeline import Pipeline
from hectorscope.session.changes import SettingsChange
from hectorscope.session.commands import (
    Command,
    Configure,
    ConfigureAll,
    Open,
    OpenUploaded,
    Play,
    Repair,
    Restart,
    SetUp,
)
from slam_core.errors import SlamError

NAMED = 4  # settings

# Why a command begins another map.
WHY: dict[type[Command], str] = {
    Restart: "Begin again",
    Repair: "To repair the sensors' messages is to begin again",
    Play: "The run has stopped; to go on is to begin again",
    Open: "To open a recording is to leave the stream",
    OpenUploaded: "To open a recording is to leave the stream",
    SetUp: "A lesson shows a recording; to open it is to leave the stream",
}

Change = Callable[[Configure | ConfigureAll], SettingsChange | None]


@dataclass(frozen=True, slots=True)
class Loss:
    """text: what would be lost. agree, decline: the words of the buttons."""

    text: str
    agree: str
    decline: str


def loss(command: Command, pipeline: Pipeline, change: Change, *, stopped: bool) -> Loss | None:
    """What a stream would lose by a command; None if nothing. stopped: playing on would begin again."""
    if not pipeline.scans:
        return None
    match command:
        case Play() if not stopped:
            return None
        case Repair() if stopped:
            return None
        case Configure() | ConfigureAll():
            return _loss_by_settings(command, pipeline, change)
    why = next((why for kind, why in WHY.items() if isinstance(command, kind)), "")
    return _map_loss(why, pipeline) if why else None


def _map_loss(why: str, pipeline: Pipeline) -> Loss:
    seconds = (pipeline.time_ns - (pipeline.start_ns or 0)) / 1e9
    return Loss(
        f"{why}: the map of {seconds:.0f} s ({pipeline.scans} scans), its trajectory and its record give way to a"
        " new run. For one minute they can be brought back.",
        "Begin a new map",
        "Keep the map",
    )


def _loss_by_settings(command: Configure | ConfigureAll, pipeline: Pipeline, change: Change) -> Loss | None:
    try:
        planned = change(command)
    except SlamError:
        return None  # it will be refused
    if planned is None:
        return None
    if planned.begins_again:
        return _map_loss(f"{planned.text} needs a new map", pipeline)
    if not planned.by_hand:
        return None
    rest = len(planned.by_hand) - NAMED
    names = ", ".join(planned.by_hand[:NAMED]) + (f" and {rest} more" if rest > 0 else "")
    title = command.title if isinstance(command, ConfigureAll) else command.name
    return Loss(
        f"{title[:1].upper()}{title[1:]} changes {len(planned.old)} settings, among them values that were set by"
        f" hand: {names}. For one minute they can be brought back.",
        "Replace them",
        "Keep my values",
    )
