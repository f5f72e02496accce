"""What each browser looks at more closely: kept by the engine, worked out anew for every snapshot."""

from collections.abc import Mapping

from hectorscope.run.inspection import target_at, view_of
from hectorscope.run.readings import BeamTarget, Target, View
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.commands import AHEAD, Inspect, Pick

MOST = 32  # browsers that look at something at a time: each costs some tenths of a millisecond a snapshot


class Probes:
    """Belongs to the engine's thread."""

    def __init__(self) -> None:
        self._targets: dict[int, Target] = {}

    def obey(self, command: Inspect, run: ActiveRun) -> None:
        """Look at something else, or at nothing any more."""
        target = self._target(command.what, run)
        self._targets.pop(command.client, None)
        if target is not None and len(self._targets) < MOST:
            self._targets[command.client] = target

    def _target(self, what: Pick | int | None, run: ActiveRun) -> Target | None:
        if isinstance(what, Pick):
            return target_at(what.places, what.reach, run.pipeline.result, run.pipeline.slam.map)
        if what == AHEAD and (result := run.pipeline.result):
            return BeamTarget(result.beams // 2)
        return None if what is None or what < 0 else BeamTarget(what)

    def views(self, run: ActiveRun) -> Mapping[int, View | None]:
        """What each browser sees of its target, by the number of the browser."""
        return {client: view_of(target, run.pipeline, run.checkpoints) for client, target in self._targets.items()}
