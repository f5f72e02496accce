"""The flags of `hectorscope live` about what is recorded, going on after a crash, and viewers."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import tyro

from hectorscope.cli.options import PublishArg, optional
from hectorscope.common.paths import absence
from hectorscope.inputs import LinkOptions, SourceOptions
from hectorscope.sources import open_source
from slam_core.errors import SlamError

if TYPE_CHECKING:
    from hectorscope.session.station import Station

OFF = "off"
VIEWER_TOKEN = "HECTORSCOPE_VIEWER_TOKEN"


class StationError(SlamError):
    """The flags of the station contradict each other."""


class StationOptions(NamedTuple):
    """made: makes the station of a stream, on which much is imported. viewer_token: of who may only look.

    publish: addresses at which the results are published.
    """

    made: "Callable[[], Station] | None" = None
    viewer_token: str | None = None
    publish: tuple[str, ...] = ()


NO_STATION = StationOptions()


@dataclass
class StationFlags:
    """What is left on the disk while a robot is shown."""

    record: Annotated[
        Path | None,
        optional(
            "Folder for every message of the stream, as MCAP; `view` replays it. The page can switch it off."
        ),
    ] = None
    journal: Annotated[
        str,
        tyro.conf.arg(
            metavar="DIR|off",
            help="Folder for what it takes to go on after a crash.",
            help_behavior_hint="(default: the person's folder for states of programs)",
        ),
    ] = ""
    resume: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        tyro.conf.arg(help="Go on with the run of this address that ended without being closed."),
    ] = False

    ca: Annotated[
        Path | None, optional("Certificate (PEM) of an issuer to trust, for wss:// and rosbridges://.")
    ] = None
    header: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        tyro.conf.arg(
            metavar="NAME=VALUE", help="Header for the handshake with the robot; give it again for more."
        ),
    ] = ()
    viewer_token: Annotated[
        str | None,
        optional(
            f"Secret of browsers that may only look, beside --token; also from {VIEWER_TOKEN} in the environment."
        ),
    ] = None
    publish: PublishArg = ()

    def link(self) -> LinkOptions:
        """How the robot is reached; StationError for a header that is none."""
        pairs = [each.partition("=") for each in self.header]
        if wrong := next((name for name, equals, _ in pairs if not (name and equals)), None):
            raise StationError(f"--header {wrong!r} is no header: give NAME=VALUE")
        return LinkOptions(str(self.ca) if self.ca else None, tuple((name, value) for name, _, value in pairs))

    def options(self, address: str, options: SourceOptions) -> StationOptions:
        """What the page needs of them; SlamError for flags that contradict each other."""
        if self.resume and self.journal == OFF:
            raise StationError("--resume needs a journal: leave --journal off out")
        made = partial(_made, self, address, options)
        return StationOptions(made, self.viewer_token or os.environ.get(VIEWER_TOKEN), self.publish)


def _made(flags: StationFlags, address: str, options: SourceOptions) -> "Station":
    from hectorscope.session.journal import Journal  # noqa: PLC0415
    from hectorscope.session.journal_files import journal_folder  # noqa: PLC0415
    from hectorscope.session.station import Station  # noqa: PLC0415

    root = Path(flags.journal) if flags.journal else journal_folder()
    journal = None
    if flags.journal != OFF and root is not None:
        journal = Journal(root, address, lambda folder: open_source(str(folder), options))
    if flags.resume and (journal is None or journal.past is None):
        raise StationError(
            f"no run of {address} ended without being closed: leave --resume out"
            + (f" ({root} {absence(root)})" if root and absence(root) else "")
        )
    return Station(flags.record, journal, resume=flags.resume)


StationArgs = Annotated[StationFlags, tyro.conf.arg(name="")]
