"""Ellipses of planar covariances as a small drawing: before a fusion, what was fused, and after."""

import math

import numpy as np

from hectorscope.panels._format import fixed
from slam_core.results import PlanarGaussian

SIGMAS = 2.0
RADIUS = 46.0  # drawing units from the middle to the rim
LADDER = (1.0, 2.0, 5.0)  # lengths of the scale bar, times a power of ten


def ellipses_svg(layers: dict[str, PlanarGaussian], centre: PlanarGaussian) -> str:
    """Each layer in its own colour, around the mean of `centre`; x of the map to the right, y up."""
    reach = max((_reach(layer, centre) for layer in layers.values()), default=0.0)
    if not 0.0 < reach < math.inf:
        return ""
    scale = RADIUS / reach
    shapes = "".join(_ellipse(name, layer, centre, scale) for name, layer in layers.items())
    bar = _bar(reach)
    return (
        '<svg class="hs-ellipses" viewBox="-54 -54 108 108" role="img" aria-label="Ellipses of the last fusion">'
        f'<path class="axes" d="M-50 0H50M0-50V50"/>{shapes}'
        f'<path class="bar" d="M50 44v3h{-bar * scale:.1f}v-3"/>'
        f'<text x="50" y="41">{_length(bar)}</text></svg>'
    )


def _axes(layer: PlanarGaussian) -> tuple[float, float, float]:
    """Half axes of the ellipse in metres, the longer first, and the turn of the longer in radians."""
    variances, vectors = np.linalg.eigh(layer.covariance[:2, :2])
    short, long = (SIGMAS * np.sqrt(np.maximum(variances, 0.0))).tolist()
    return long, short, math.atan2(vectors[1, 1], vectors[0, 1])


def _reach(layer: PlanarGaussian, centre: PlanarGaussian) -> float:
    away = layer.mean[:2] - centre.mean[:2]
    return math.hypot(*away.tolist()) + _axes(layer)[0]


def _ellipse(name: str, layer: PlanarGaussian, centre: PlanarGaussian, scale: float) -> str:
    long, short, turn = _axes(layer)
    x, y = (scale * (layer.mean[:2] - centre.mean[:2])).tolist()
    return (
        f'<g class="hs-of-{name}" transform="translate({x:.1f} {-y:.1f}) rotate({-math.degrees(turn):.0f})">'
        f'<ellipse rx="{scale * long:.1f}" ry="{max(scale * short, 0.6):.1f}"/><circle r="1.5"/></g>'
    )


def _bar(reach: float) -> float:
    """The longest round length up to two thirds of the reach, metres."""
    wanted = 0.67 * reach
    decade = 10.0 ** math.floor(math.log10(wanted))
    return max(step * decade for step in LADDER if step * decade <= wanted)


def _length(metres: float) -> str:
    return f"{fixed(metres, 0)} m" if metres >= 1.0 else f"{1e3 * metres:g} mm"
