"""How the robot is turned: an artificial horizon, a compass in the map's axes, and the numbers.

The dials are sent once; what moves is a handful of CSS variables, 100 bytes an update.
"""

import math

from viser import Icon

from app.panels import _workspace
from app.panels._dials import compass_svg, horizon_svg, turn_css
from app.panels._format import figure, fixed
from app.panels._handles import put
from app.snapshot import Snapshot
from app.web.stage import Stage


class AttitudePanel:
    """Roll right side down and pitch nose down are positive (REP-103); the horizon turns the other way."""

    title = "Attitude"
    order = 20
    rate = 10.0

    def __init__(self, stage: Stage) -> None:
        gui = stage.server.gui
        with _workspace.tab(stage, "Live", Icon.GAUGE):
            _workspace.mark(stage, "live")
            gui.add_html(f'<div class="hs-attitude">{horizon_svg("hs-live-horizon")}{compass_svg()}</div>')
            self._turn = gui.add_html("")
            self._numbers = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Turn the dials, if the pose changed."""
        if len(snapshot.series) == 0:
            return
        row = snapshot.series[-1]
        pose = {name: float(row[name]) for name in ("x", "y", "z", "roll", "pitch", "yaw")}
        put(self._turn, turn_css("hs-attitude", pose["roll"], pose["pitch"], pose["yaw"]))
        put(self._numbers, numbers_html(pose))


def numbers_html(pose: dict[str, float]) -> str:
    """Angles in degrees, positions in metres."""
    angles = [(name, fixed(math.degrees(pose[name]), 1) + "°") for name in ("roll", "pitch", "yaw")]
    places = [(name, fixed(pose[name], 2) + " m") for name in ("x", "y", "z")]
    return f'<div class="hs-pose">{"".join(figure(*cell) for cell in angles + places)}</div>'


PANEL = AttitudePanel
