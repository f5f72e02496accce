"""Covariances on a room, a corridor and open water beside each other: pictures and figures on the card alone."""

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

import numpy as np

from hectorscope.panels import _xray_words as words
from hectorscope.panels._format import fixed, number
from hectorscope.run.xray.covariances import Cloud, fusion
from hectorscope.run.xray.match_problem import MatchProblem
from hectorscope.run.xray.places import Kind, place
from slam_core.geometry import transform_points
from slam_core.measurements import Float64s

TITLES: Mapping[Kind, str] = {"room": "Room", "corridor": "Corridor", "water": "Open water"}
NAMES = {"match": "R (15)", "sampled": "sampled", "cloud": "cloud"}
SIDE = 120.0  # of a picture, in units of its own
SEEN = 6.0  # metres from the robot to the edge of a picture
LONGEST = 0.42 * SIDE  # radius of the largest ellipse
OMEGA = 0.5  # of the fusion, which is not shown here

Keep = Callable[[Any, Callable[[], Any]], Any]


@dataclass(frozen=True, eq=False)
class Compared:
    """Covariances (3, 3) of one scan, by their names: of eq. (15), by samples, and the cloud of noisy matches."""

    kind: Kind
    problem: MatchProblem
    cloud: Cloud
    found: Mapping[str, Float64s]

    @property
    def covariances(self) -> dict[str, Float64s]:
        """The cloud as far as it is there."""
        return {**self.found, **({"cloud": self.cloud.covariance} if len(self.cloud) > 1 else {})}


def compared(keep: Keep, noise: float, slice_s: float) -> Iterator[str]:
    """HTML, better each time. keep: gives what was made before. noise: of a range, metres."""
    places: list[Compared] = []
    for kind in get_args(Kind):
        yield _html(places) + f"<p>{TITLES[kind]}: a short drive is simulated.</p>"
        places.append(keep(("place", kind, noise), partial(compare, kind, noise)))
    for each in places:
        while not each.cloud.whole:
            yield _html(places)
            ends = time.monotonic() + slice_s
            while time.monotonic() < ends and not each.cloud.whole:
                each.cloud.try_next()
    yield _html(places)


def compare(kind: Kind, noise: float) -> Compared:
    """Of the scan of a place, with an empty cloud."""
    problem = place(kind)
    both = fusion(problem, OMEGA)
    return Compared(kind, problem, Cloud(problem, noise), {"match": both.R, "sampled": both.sampled})


def along_axes(covariances: Mapping[str, Float64s]) -> dict[str, tuple[float, float, float]]:
    """One sigma along the long and the short axis of the last covariance, metres, and of psi, radians."""
    *_, last = covariances.values()
    short, long = np.linalg.eigh(last[:2, :2])[1].T
    return {
        name: (_sigma(C[:2, :2], long), _sigma(C[:2, :2], short), math.sqrt(C[2, 2]))
        for name, C in covariances.items()
    }


def _sigma(covariance: Float64s, axis: Float64s) -> float:
    return math.sqrt(float(axis @ covariance @ axis))


def _html(places: list[Compared]) -> str:
    whole = [each for each in places if each.cloud.whole]
    return "".join(map(place_html, places)) + (shares_html(whole) + NOTE if places else "")


NOTE = (
    "<p>Simulated scans by the default settings; long and short are the axes of the cloud. Its matches begin at"
    " ξ*: it knows of noise alone, not of errors of the map.</p>"
)


def shares_html(places: list[Compared]) -> str:
    """How long R is beside the cloud, along its long axis; empty before a cloud is whole."""
    told = []
    for each in places:
        long = {name: values[0] for name, values in along_axes(each.covariances).items()}
        shares = [number(long[name] / max(long["cloud"], 1e-12), 2) for name in ("match", "sampled")]
        told.append(f"{TITLES[each.kind].lower()} {shares[0]} and {shares[1]}")
    return f"<p>Share of the cloud's long axis, by (15) and by samples: {'; '.join(told)}.</p>" if told else ""


def place_html(shown: Compared) -> str:
    """A picture of the scan with its ellipses, and one sigma of each covariance."""
    covariances = shown.covariances
    rows = [
        (f'<i class="hs-xray-key hs-xray-{name}"></i>{NAMES[name]}', *_worded(values))
        for name, values in along_axes(covariances).items()
    ]
    title = f"<h3>{TITLES[shown.kind]} · {len(shown.problem.points)} beams · cloud of {len(shown.cloud)}</h3>"
    figures = words.table(("σ, mm", "long", "short", "ψ, °"), rows)
    return f'{title}<div class="hs-xray-beside">{picture(shown.problem, covariances)}{figures}</div>'


def _worded(values: tuple[float, float, float]) -> tuple[str, str, str]:
    along, across, psi = values
    return fixed(1e3 * along, 2), fixed(1e3 * across, 2), fixed(float(np.degrees(psi)), 3)


def picture(problem: MatchProblem, covariances: Mapping[str, Float64s]) -> str:
    """The endpoints around the robot, and the ellipses enlarged alike; north of the map is up."""
    metre = 0.5 * SIDE / SEEN
    ends = metre * (transform_points(problem.matched, problem.points) - problem.matched[:2])
    near = ends[np.abs(ends).max(axis=1) < 0.5 * SIDE]
    dots = "".join(f"M{x:.1f} {-y:.1f}h0" for x, y in near.tolist())
    largest = max(float(np.linalg.eigvalsh(C[:2, :2])[-1]) for C in covariances.values()) ** 0.5
    shapes = "".join(_ellipse(name, C, LONGEST / max(largest, 1e-12)) for name, C in covariances.items())
    box = f"{-SIDE / 2:g} {-SIDE / 2:g} {SIDE:g} {SIDE:g}"
    return (
        f'<svg class="hs-xray-place" viewBox="{box}" role="img" aria-label="Endpoints and ellipses">'
        f'<path class="hs-xray-ends" d="{dots}"/>{shapes}</svg>'
    )


def _ellipse(name: str, covariance: Float64s, scale: float) -> str:
    values, axes = np.linalg.eigh(covariance[:2, :2])
    short, long = (scale * np.sqrt(np.maximum(values, 0.0))).tolist()
    angle = np.degrees(np.arctan2(axes[1, 1], axes[0, 1]))
    return f'<ellipse class="hs-xray-{name}" rx="{long:.1f}" ry="{short:.1f}" transform="rotate({-angle:.1f})"/>'
