"""What a sweep varies: `matcher.sigma=0.1,0.2,0.4`, `fusion.omega=0.01:0.5:log5`, `sensors.scan_delay=0:0.2`."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from hectorscope.inputs import SENSOR_OPTIONS
from hectorscope.run.settings_file import sensor_options
from hectorscope.sweep.spec import SENSORS
from slam_core.config import SlamConfig
from slam_core.config.leaves import Leaves
from slam_core.errors import SlamError, nearest

RANGE = re.compile(r"(?P<low>[^:]+):(?P<high>[^:]+)(:(?P<log>log)?(?P<count>\d*))?")
MOST = 100_000  # runs
DIGITS = 4  # of a value that is computed


class VaryError(SlamError):
    """What is to be varied is not understood."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One setting that is varied. values: those that are listed or stepped through; none of a range without steps.

    low, high: of a range, else None. log: its steps are factors.
    """

    name: str
    values: tuple[Any, ...]
    low: float | None = None
    high: float | None = None
    log: bool = False

    def at(self, share: float) -> Any:
        """The value at a share, 0 to 1, of the axis: of a range any, else one of the values."""
        if self.low is None or self.high is None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        return fitting(self.name, _between(self.low, self.high, share, log=self.log))


def parse(text: str) -> Axis:
    """The axis of NAME=VALUE,VALUE or NAME=LOW:HIGH[:[log]COUNT]; VaryError or ConfigError for a bad one."""
    name, equals, rest = (part.strip() for part in text.partition("="))
    if not (equals and rest):
        raise VaryError(f"--vary {text!r} gives no value: write NAME=VALUE,VALUE or NAME=LOW:HIGH:COUNT")
    found = RANGE.fullmatch(rest)
    if found:
        return _range(name, text, found)
    return Axis(name, tuple(dict.fromkeys(fitting(name, _value(word)) for word in rest.split(","))))


def _range(name: str, text: str, found: re.Match[str]) -> Axis:
    low, high, log = _value(found["low"]), _value(found["high"]), bool(found["log"])
    if not all(isinstance(end, float | int) and not isinstance(end, bool) for end in (low, high)) or low >= high:
        raise VaryError(f"--vary {text!r} is no range: give a lower and a higher number")
    if log and low <= 0:
        raise VaryError(f"--vary {text!r} begins at {low:g}: a logarithmic range needs a number above 0")
    count = int(found["count"] or 0)
    if count == 1 or count > MOST:
        raise VaryError(f"--vary {text!r} has {count} steps: give 2 to {MOST}")
    for end in (low, high):
        fitting(name, end)
    shares = (k / (count - 1) for k in range(count))
    values = (fitting(name, _between(low, high, share, log=log)) for share in shares)
    return Axis(name, tuple(dict.fromkeys(values)), float(low), float(high), log)


def _between(low: float, high: float, share: float, *, log: bool) -> float:
    value = low * (high / low) ** share if log else low + (high - low) * share
    return float(f"{value:.{DIGITS}g}")


def _value(text: str) -> Any:
    text = text.strip()
    if text in {"true", "false"}:
        return text == "true"
    try:
        return float(text) if re.search(r"[.eE]|inf|nan", text) else int(text)
    except ValueError:
        return text


def fitting(name: str, value: Any) -> Any:
    """A value as the setting or sensor option takes it; ConfigError if it does not fit, or there is none."""
    if name.startswith(SENSORS):
        option = name.removeprefix(SENSORS)
        if option not in SENSOR_OPTIONS:
            near = nearest(option, SENSOR_OPTIONS)
            remedy = f"did you mean {SENSORS}{near}?" if near else f"there are {', '.join(SENSOR_OPTIONS)}"
            raise VaryError(f"{name} is no sensor option: {remedy}")
        return sensor_options({option: value})[option]
    leaf = Leaves(SlamConfig())[name]
    if leaf.type is int and isinstance(value, float) and math.isfinite(value):
        value = round(value)
    return leaf.check(value)


def combinations(axes: Sequence[Axis]) -> Iterator[Mapping[str, Any]]:
    """Every combination of the values, the last axis fastest; VaryError for a range without steps, or too many."""
    for axis in axes:
        if not axis.values:
            raise VaryError(
                f"--vary {axis.name} is a range without steps: add a count, as in :5 or :log5, or --search N"
            )
    if (count := math.prod(len(axis.values) for axis in axes)) > MOST:
        raise VaryError(f"the values combine to {count} settings: give at most {MOST}, or --search N")
    for values in product(*(axis.values for axis in axes)):
        yield dict(zip((axis.name for axis in axes), values, strict=True))


def check_axes(axes: Sequence[Axis]) -> None:
    """VaryError for a setting that is varied twice."""
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise VaryError(f"--vary {name} is given {names.count(name)} times: put its values into one")
