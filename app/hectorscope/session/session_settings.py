"""The settings of the shown run, changed by hand: from now on, for the whole run, or at the scan that is shown."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from hectorscope.run.settings import Setting
from hectorscope.session.changes import SettingsChange, settings_change
from hectorscope.session.commands import Configure, ConfigureAll
from hectorscope.session.undo import KeptValues

if TYPE_CHECKING:
    from hectorscope.session.session import Session


class SessionSettings:
    """Belongs to the engine's thread."""

    def __init__(self, session: "Session") -> None:
        self._session = session

    def planned(self, command: Configure | ConfigureAll) -> SettingsChange | None:
        """What a command makes of the settings; None if nothing. SlamError if it is to be refused."""
        session = self._session
        values: Mapping[str, Setting]
        match command:
            case Configure(name, value, throughout):
                title, values = "", {name: value}
            case ConfigureAll(title, values, throughout):
                pass
        return settings_change(
            session.run.settings,
            values,
            title,
            session.now_ns,
            throughout=throughout and not session.source.live,
            prior_map=session.prior_map,
        )

    def change(self, planned: SettingsChange) -> None:
        """Change them; one line of the log has the change of the one, or how many changed."""
        session = self._session
        entry = session.entry(planned.text)
        if planned.begins_again:
            self._rebuild(planned)
        else:
            if planned.by_hand:
                session.undone.push(planned.text.split(":")[0], KeptValues(planned.old))
            session.run.configure(planned.after, session.now_ns)
        session.publisher.log(entry)

    def _rebuild(self, planned: SettingsChange) -> None:
        """The same instant with another map; a stream cannot go back, so its map begins anew."""
        session = self._session
        target_ns = session.transport.target_ns or session.run.pipeline.time_ns
        session.begin(planned.after, planned.text)
        if session.source.live:
            session.log("A new map was begun: a live stream cannot be run again", "warning")
        else:
            session.transport.seek(target_ns)

    def process_again(self) -> None:
        """Process the scan at which the run rested, with the settings that changed meanwhile."""
        session = self._session
        if session.run.process_again():
            session.transport.processed_again = True
            session.epoch += 1
