"""An artificial horizon and a compass: drawn once, then turned by a handful of CSS variables."""

import math

import numpy as np

UNIT = 1.6  # drawing units a degree of pitch; the dial's radius is 50
RUNGS = (-20, -10, 10, 20)  # degrees of the pitch ladder
BANKS = (-60, -45, -30, -15, 0, 15, 30, 45, 60)


def turn_css(place: str, roll: float, pitch: float, yaw: float) -> str:
    """The variables that turn the dials in elements of the class `place`; angles in radians."""
    degrees = [float(np.nan_to_num(math.degrees(angle))) for angle in (roll, pitch, yaw)]
    lift = 0.0 - max(-90.0, min(90.0, degrees[1])) * UNIT
    turned = f"--hs-roll:{0.0 - degrees[0]:.1f}deg;--hs-lift:{lift:.1f}px;--hs-yaw:{0.0 - degrees[2]:.1f}deg"
    return f"<style>.{place}{{{turned}}}</style>"


def horizon_svg(name: str) -> str:
    """The artificial horizon, level; `name` must be its own on the page."""
    ladder = "".join(
        f'<path class="rung" d="M-{9 if rung % 20 else 16} {-rung * UNIT:g}H{9 if rung % 20 else 16}"/>'
        for rung in RUNGS
    )
    banks = "".join(
        f'<path class="tick" transform="rotate({bank})" d="M0-48V-{42 if bank % 30 else 39}"/>' for bank in BANKS
    )
    return (
        '<svg class="hs-dial" viewBox="-54 -54 108 108" role="img" aria-label="Artificial horizon">'
        f'<clipPath id="{name}"><circle r="50"/></clipPath><g clip-path="url(#{name})"><g class="roll">'
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
