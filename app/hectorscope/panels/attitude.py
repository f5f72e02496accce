"""How the robot is turned: an artificial horizon, a compass in the map's axes, and the numbers.

The dials are sent once; what moves is a handful of CSS variables, 100 bytes an update.
"""

import math

from viser import Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._dials import compass_svg, horizon_svg, turn_css
from hectorscope.panels._format import figure, fixed
from hectorscope.panels._handles import put
from hectorscope.session.snapshot import Snapshot


class AttitudePanel:
    """Roll right side down and pitch nose down are positive (REP-103); the horizon turns the other way."""

    title = "Attitude"
    order = 20
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        gui = scene.server.gui
        with _workspace.tab(scene, "Live", Icon.GAUGE):
            _workspace.mark(scene, "live")
            gui.add_html(f'<div class="hs-attitude">{horizon_svg("hs-live-horizon")}{compass_svg()}</div>')
            self._turn = gui.add_html("")
            self._numbers = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Turn the dials, if the pose changed."""
        if len(snapshot.series) == 0:
            put(self._turn, "")
            put(self._numbers, "")
            return
        row = snapshot.series[-1]
        pose = {name: float(row[name]) for name in ("x", "y", "z", "roll", "pitch", "yaw")}
        planar = is_planar(snapshot)
        turn = turn_css("hs-attitude", pose["roll"], pose["pitch"], pose["yaw"])
        put(self._turn, turn + (FADED if planar else ""))
        put(self._numbers, numbers_html(pose, planar=planar))


def is_planar(snapshot: Snapshot) -> bool:
    """Whether attitude and height are unobserved: they are taken to be zero."""
    result, row = snapshot.result, snapshot.series[-1]
    return (result is None or result.navigation is None) and not any(row[name] for name in TAKEN)


def numbers_html(pose: dict[str, float], *, planar: bool = False) -> str:
    """Angles in degrees, positions in metres. planar: a dash for what nobody measures."""
    angles = {name: fixed(math.degrees(pose[name]), 1) + "°" for name in ("roll", "pitch", "yaw")}
    figures = angles | {name: fixed(pose[name], 2) + " m" for name in ("x", "y", "z")}
    if planar:
        figures |= dict.fromkeys(TAKEN, "–")
    cells = (figure(name, shown, more=PLANAR if shown == "–" else "") for name, shown in figures.items())
    return f'<div class="hs-pose">{"".join(cells)}</div>'


TAKEN = ("roll", "pitch", "z")
FADED = "<style>.hs-attitude{--hs-horizon:.3}</style>"
PLANAR = "nothing measures it here, the laser is taken to be level"


PANEL = AttitudePanel
