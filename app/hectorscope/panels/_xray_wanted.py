"""What a browser wants to see of the matcher: checked, like all that browsers send."""

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

from hectorscope.panels import _request
from hectorscope.run.xray import Plane

Lab = Literal["steps", "landscape", "lens", "covariance", "attitude"]
Show = Literal["heat", "surface", "basin"]
Of = Literal["scan", "places"]
MOST_STEPS = 10_000
SPAN, YAW = (0.1, 5.0), math.radians(30.0)
PITCH = (0.0, math.pi / 2)
OMEGA, NOISE = (0.001, 0.999), (0.001, 0.2)


@dataclass(frozen=True, slots=True)
class Wanted:
    """step: of the iterations, from 0. span: of the landscape, metres to each side; yaw: radians it is turned by.

    at: level, x, y that the lens looks at. omega: of the fusion. noise: of ranges in the cloud, metres.
    of: the covariances of the scan, or of a room, a corridor and open water. pitch: of eq. (1), radians.
    keep: whether the scan stays while the run goes on.
    """

    lab: Lab = "steps"
    step: int = 0
    level: int = 0
    plane: Plane = "xy"
    span: float = 1.0
    yaw: float = 0.0
    show: Show = "heat"
    at: tuple[int, float, float] | None = None
    omega: float = 0.5
    noise: float = 0.02
    of: Of = "scan"
    pitch: float = 0.0
    keep: bool = False


def wanted_of(asked: dict[str, Any]) -> Wanted:
    """The values in their ranges; BadRequest for what no script of ours sends."""
    number, whole = _request.number, _request.whole
    return Wanted(
        lab=_word(asked.get("lab"), Lab),
        step=whole(asked.get("step"), 0, MOST_STEPS),
        level=whole(asked.get("level"), 0, _request.MOST_LEVELS - 1),
        plane=_word(asked.get("plane"), Plane),
        span=number(asked.get("span"), *SPAN),
        yaw=number(asked.get("yaw"), -YAW, YAW),
        show=_word(asked.get("show"), Show),
        at=None if asked.get("at") is None else _request.place(asked["at"]),
        omega=number(asked.get("omega"), *OMEGA),
        noise=number(asked.get("noise"), *NOISE),
        of=_word(asked.get("of"), Of),
        pitch=number(asked.get("pitch"), *PITCH),
        keep=asked.get("keep") is True,
    )


def _word(value: Any, words: Any) -> Any:
    if value not in get_args(words):
        raise _request.BadRequest
    return value
