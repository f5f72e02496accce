"""Follows a permalink: the recording, the settings and the time that it asks for, by what a hand could do too."""

from collections.abc import Callable, Mapping

from hectorscope.inputs import OptionValue
from hectorscope.run.permalink import Permalink, PermalinkError
from hectorscope.run.run_file import RunFile
from hectorscope.session.changes import check_map
from hectorscope.session.commands import SetUp
from hectorscope.session.library import Library
from hectorscope.session.losses import Loss
from hectorscope.session.session import Session


class Following:
    """Belongs to the engine's thread. opening: hears what is looked for or opened now, and "" once it is."""

    def __init__(self, session: Session, library: Library, opening: Callable[[str], None]) -> None:
        self._session, self._library, self._opening = session, library, opening

    def loss(self, link: Permalink) -> Loss | None:
        """What would give way that a hand has made; None if nothing."""
        session = self._session
        scans = session.run.pipeline.scans
        if not scans or (self._is_open(link) and session.run.settings == link.settings):
            return None
        if not session.source.live and session.run.settings == session.given:
            return None
        what = (
            "the map of the stream" if session.source.live else "the run with the settings that were set by hand"
        )
        return Loss(
            f"The link shows another run: {what} ({scans} scans) gives way. For one minute it can be brought"
            " back.",
            "Follow the link",
            "Stay here",
        )

    def follow(
        self,
        link: Permalink,
        sensors: Mapping[str, OptionValue] | None = None,
        slot: int | None = None,
    ) -> None:
        """Show what the link asks for, and rest there; SlamError, and nothing is changed, if that cannot be.

        sensors: the `SENSOR_OPTIONS` to open the recording with; None for those of now. slot: the number of a run
        of the list, in which the present one stays; None for one more.
        """
        session = self._session
        self._check_prior(link)
        check_map(link.settings.start.map, session.prior_map)
        if not self._is_open(link) or sensors not in (None, session.source.report.sensors):
            self._open(link, sensors, slot)
        elif slot is not None:
            session.switch(link.settings, slot)
        elif session.run.settings != link.settings:
            session.begin(link.settings, "following a link", session.named.new_slot(link.name))
        session.given = link.settings
        session.transport.pause()
        session.seek((session.run.pipeline.start_ns or 0) + link.offset_ns)

    def follow_kept(self, run: RunFile) -> None:
        """Show a kept run; once it is there, it is compared with what was kept of it."""
        self.follow(run.link, run.sensors)
        self._session.named.expected = run
        shown = self._session.run
        shown.annotations = shown.annotations.joined(run.annotations)

    def set_up(self, wanted: SetUp) -> None:
        """The scene of a lesson, in a run of its own; what is there already stays as it is."""
        session, key = self._session, self._library.demo(wanted.demo)
        check_map(wanted.settings.start.map, session.prior_map)
        if session.intake.path != self._library.path(key):
            self._opening(f"Opening {wanted.demo}")
            source, path = self._library.open(key)
            session.open(source, path, wanted.settings, name=wanted.title)
        elif session.run.settings != wanted.settings:
            session.begin(wanted.settings, "the scene of a lesson", session.named.new_slot(wanted.title))
        session.given = wanted.settings
        session.transport.pause()
        session.seek((session.run.pipeline.start_ns or 0) + wanted.offset_ns)

    def _open(self, link: Permalink, sensors: Mapping[str, OptionValue] | None, slot: int | None) -> None:
        self._opening("Looking for the recording of the link")
        key = self._library.find(link.recording)
        if key is None:
            raise PermalinkError(
                f"The recording of this link ({link.recording.size / 2**20:.1f} MiB) is none of those that can be"
                " opened here: put it into a folder given by --folder, or drop it onto the page, and follow the"
                " link again"
            )
        self._opening(f"Opening {self._library.name(key)}")
        session, (source, path) = self._session, self._library.open(key, sensors or {})
        session.open(source, path, link.settings, slot, link.name)

    def _check_prior(self, link: Permalink) -> None:
        """PermalinkError unless the run of the link begins with the prior map of this program, if with any."""
        if link.map_sha256 == self._session.map_sha256:
            return
        begins = f"the saved map {link.map_sha256[:12]}" if link.map_sha256 else "an empty map"
        here = f"{self._session.map_sha256[:12]}" if self._session.map_sha256 else "no map"
        remedy = "with that --map, --mode and --start" if link.map_sha256 else "without --map"
        raise PermalinkError(f"This run begins with {begins}, this program has {here}: start it {remedy}")

    def _is_open(self, link: Permalink) -> bool:
        path = self._session.intake.path
        return path is not None and self._library.identities.is_at(link.recording, path)
