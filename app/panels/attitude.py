"""How the robot is turned: an artificial horizon, a compass in the map's axes, and the numbers.

The dials are sent once; what moves is a handful of CSS variables, 100 bytes an update.
"""

import math

import numpy as np
from viser import Icon

from app.panels import _workspace
from app.panels._format import figure, fixed
from app.panels._handles import put
from app.snapshot import Snapshot
from app.web.stage import Stage

UNIT = 1.6  # drawing units a degree of pitch; the dial's radius is 50
RUNGS = (-20, -10, 10, 20)  # degrees of the pitch ladder
BANKS = (-60, -45, -30, -15, 0, 15, 30, 45, 60)


class AttitudePanel:
    """Roll right side down and pitch nose down are positive (REP-103); the horizon turns the other way."""

    title = "Attitude"
    order = 20
    rate = 10.0

    def __init__(self, stage: Stage) -> None:
        gui = stage.server.gui
        with _workspace.tab(stage, "Live", Icon.GAUGE):
            _workspace.mark(stage, "live")
            gui.add_html(f'<div class="hs-attitude">{horizon_svg()}{compass_svg()}</div>')
            self._turn = gui.add_html("")
            self._numbers = gui.add_html("")

    def draw(self, snapshot: Snapshot) -> None:
        """Turn the dials, if the pose changed."""
        if len(snapshot.series) == 0:
            return
        row = snapshot.series[-1]
        pose = {name: float(row[name]) for name in ("x", "y", "z", "roll", "pitch", "yaw")}
        put(self._turn, turn_css(pose["roll"], pose["pitch"], pose["yaw"]))
        put(self._numbers, numbers_html(pose))


def turn_css(roll: float, pitch: float, yaw: float) -> str:
    """The variables that turn the dials; angles in radians."""
    degrees = [float(np.nan_to_num(math.degrees(angle))) for angle in (roll, pitch, yaw)]
    lift = 0.0 - max(-90.0, min(90.0, degrees[1])) * UNIT
    turned = f"--hs-roll:{0.0 - degrees[0]:.1f}deg;--hs-lift:{lift:.1f}px;--hs-yaw:{0.0 - degrees[2]:.1f}deg"
    return f"<style>.hs-attitude{{{turned}}}</style>"


def numbers_html(pose: dict[str, float]) -> str:
    """Angles in degrees, positions in metres."""
    angles = [(name, fixed(math.degrees(pose[name]), 1) + "°") for name in ("roll", "pitch", "yaw")]
    places = [(name, fixed(pose[name], 2) + " m") for name in ("x", "y", "z")]
    return f'<div class="hs-pose">{"".join(figure(*cell) for cell in angles + places)}</div>'


def horizon_svg() -> str:
    """The artificial horizon, level."""
    ladder = "".join(
        f'<path class="rung" d="M-{9 if rung % 20 else 16} {-rung * UNIT:g}H{9 if rung % 20 else 16}"/>'
        for rung in RUNGS
    )
    banks = "".join(
        f'<path class="tick" transform="rotate({bank})" d="M0-48V-{42 if bank % 30 else 39}"/>' for bank in BANKS
    )
    return (
        '<svg class="hs-dial" viewBox="-54 -54 108 108" role="img" aria-label="Artificial horizon">'
        '<clipPath id="hs-dial"><circle r="50"/></clipPath><g clip-path="url(#hs-dial)"><g class="roll">'
        '<g class="lift">'
        '<rect class="sky" x="-120" y="-220" width="240" height="220"/>'
        '<rect class="ground" x="-120" y="0" width="240" height="220"/>'
        f'<path class="edge" d="M-120 0H120"/>{ladder}</g>{banks}</g></g>'
        '<circle class="rim" r="50"/><path class="pointer" d="M0-38l-4 7h8z"/>'
        '<path class="wings" d="M-30 0h17l5 6M30 0h-17l-5 6"/><circle class="nose" r="2"/></svg>'
    )


def compass_svg() -> str:
    """A top view in the map's axes: x to the right, y up, the robot's arrow turning."""
    ticks = "".join(
        f'<path class="tick" transform="rotate({angle})" d="M0-48V-{39 if angle % 90 == 0 else 43}"/>'
        for angle in range(0, 360, 30)
    )
    return (
        '<svg class="hs-dial" viewBox="-54 -54 108 108" role="img" aria-label="Heading in the map">'
        f'<circle class="face" r="50"/>{ticks}<text x="31" y="4">x</text><text x="0" y="-27">y</text>'
        '<g class="heading"><path class="arrow" d="M26 0-14 13-7 0-14-13z"/></g><circle class="rim" r="50"/></svg>'
    )


PANEL = AttitudePanel
