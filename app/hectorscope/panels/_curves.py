"""Which columns of the series are drawn together, and in which units."""

import math
from dataclasses import dataclass, replace

DEGREES = 180.0 / math.pi
TIME = "time_s"  # the first column of every table


@dataclass(frozen=True, slots=True)
class Curve:
    """A column of SERIES_DTYPE under a short name."""

    column: str
    name: str
    colour: str | int  # a colour's name in Theme, or an index into Theme.series


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves that share an axis; values are multiplied by `factor`. log: by decades.

    angles: radians that go on beyond half a turn instead of jumping.
    """

    title: str
    factor: float
    curves: tuple[Curve, ...]
    log: bool = False
    angles: bool = False


def sigmas(title: str, axis: str, factor: float) -> Chart:
    """The three standard deviations of one coordinate, in the colours of their ellipses."""
    names = (("match", "match"), ("prior", "prior"), ("fused", "fused"))
    return Chart(
        title, factor, tuple(Curve(f"{name}_sigma_{axis}", name, colour) for name, colour in names), log=True
    )


def columns(title: str, factor: float, *names: str) -> Chart:
    """One curve a column, in the order of the palette; 'gyro_bias_x:x' shows it as x."""
    pairs = [name.partition(":") for name in names]
    return Chart(title, factor, tuple(Curve(c, short or c, i) for i, (c, _, short) in enumerate(pairs)))


def pair(title: str, name: str, *, log: bool = False) -> Chart:
    """The same of the shown and of the compared run, in the colours of their lines."""
    colours = (("shown", "trajectory"), ("compared", "compared"))
    return Chart(title, 1e3, tuple(Curve(f"{name}_{run}", run, colour) for run, colour in colours), log=log)


COMPARED = "Compared runs"
AGAINST_TRUTH = "Error against truth"
PAGES: dict[str, tuple[Chart, ...]] = {
    "Covariance": (sigmas("σ x, mm", "x", 1e3), sigmas("σ y, mm", "y", 1e3), sigmas("σ ψ, °", "yaw", DEGREES)),
    "Match": (
        columns("Mean residual", 1.0, "residual"),
        columns("Points on walls, %", 100.0, "fit"),
        columns("Iterations", 1.0, "iterations"),
        columns("Beams used", 1.0, "beams"),
        columns("Unexpected beams, %", 100.0, "unexpected"),
        columns("Beams that fix the weakest direction, %", 100.0, "weakest_share:share"),
    ),
    AGAINST_TRUTH: (
        columns("Position in the plane, mm", 1e3, "error:distance"),
        columns("Heading, °", DEGREES, "error_yaw:heading"),
        columns("Height, mm", 1e3, "error_z:height"),
    ),
    COMPARED: (
        columns("Positions apart, mm", 1e3, "apart:distance", "apart_z:height"),
        columns("Headings apart, °", DEGREES, "apart_yaw:heading"),
        pair("σ in the plane, mm", "sigma", log=True),
        pair("Error against truth, mm", "error"),
        columns("Cells of the map that differ, %", 100.0, "map_apart:share"),
    ),
    "Attitude": (
        columns("Roll and pitch, °", DEGREES, "roll", "pitch"),
        replace(columns("Yaw, °", DEGREES, "yaw"), angles=True),
        columns("Height, m", 1.0, "z"),
    ),
    "Biases": (
        columns("Gyro bias, °/s", DEGREES, "gyro_bias_x:x", "gyro_bias_y:y", "gyro_bias_z:z"),
        columns("Accelerometer bias, m/s²", 1.0, "accel_bias_x:x", "accel_bias_y:y", "accel_bias_z:z"),
    ),
    "Motion": (columns("Velocity, m/s", 1.0, "vx:x", "vy:y", "vz:z"), columns("Map updates", 1.0, "map_updates")),
    "Time spent": (
        columns(
            "A scan's time, ms",
            1.0,
            "stabilise_ms:stabilise",
            "match_ms:match",
            "update_ms:map",
            "filter_ms:filter",
        ),
    ),
}

# What is sent of SERIES_DTYPE: time, then every column that a chart draws.
COLUMNS = (
    TIME,
    *(
        c.column
        for page, charts in PAGES.items()
        if page not in {AGAINST_TRUTH, COMPARED}
        for chart in charts
        for c in chart.curves
    ),
)
