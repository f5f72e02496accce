"""docs/performance.md: what was measured, as text around the tables."""

import os
import platform
import re
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from benchmarks import kernels, others, reading, returning, start, tables
from benchmarks.accuracy import CorridorOutcome, Outcome, Outcomes, Replay
from benchmarks.cases import DRIVE_SEEDS, DRIVES, LOST_M, SEEDS, Drive, Recording
from benchmarks.ghosts import SIGHT_S, HallOutcome
from benchmarks.inertial import Ride
from benchmarks.others import Judged
from benchmarks.outage import OUTAGE_SEEDS, Outage
from benchmarks.strays import GlassOutcome, Struck
from benchmarks.whole_map import BEAMS, STARTS, Finding
from slam_core.config.presets import PAPER

ACCURACY = "\n# Accuracy\n"


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Every case, by both methods; lists are over the seeds."""

    drives: dict[Drive, list[Outcomes]]
    square: dict[Drive, list[tuple[Outcome, Outcome]]]
    localised: dict[str, list[tuple[Outcome, Outcome]]]
    corridor: list[dict[str, CorridorOutcome]]
    halls: list[dict[str, HallOutcome]]
    empty: list[dict[str, Outcome]]
    glass: list[dict[str, GlassOutcome]]
    struck: list[dict[Struck, dict[str, Outcome]]]
    outages: dict[str, list[Outage]]
    replays: dict[Recording, dict[str, Replay]]
    others: dict[Recording, dict[str, Judged]]
    inertial: dict[Recording, Ride]


def processor() -> str:
    """The model of the processor."""
    facts = Path("/proc/cpuinfo")
    named = re.search(r"^model name\s*: (.+)$", facts.read_text(), re.MULTILINE) if facts.exists() else None
    return named[1] if named else platform.processor() or platform.machine()


def machine() -> str:
    """What the times hold for."""
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "rosbags", "mcap"))
    return f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}, {libraries}"


def in_the_way(accuracy: Accuracy) -> dict[str, list[dict[str, Outcome]]]:
    """The cases that might pull a match, by name: outcomes by method, a list over the seeds."""
    cases = {
        "nobody": accuracy.empty,
        "people": [{method: run.people for method, run in seed.items()} for seed in accuracy.halls],
        "walls": [{method: run.solid for method, run in seed.items()} for seed in accuracy.glass],
        "glass in their place": [{method: run.glass for method, run in seed.items()} for seed in accuracy.glass],
    }
    drives = dict.fromkeys(case for seed in accuracy.struck for case in seed)
    cases |= {
        f"{'beams missing' if case.missing else 'stray beams'}, {case.share:.0%} at {case.rate:g} Hz": [
            seed[case] for seed in accuracy.struck
        ]
        for case in drives
    }
    return cases


def judged_anew(text: str, accuracy: Accuracy) -> str:
    """docs/performance.md with the same speed and another judgement."""
    return text.split(ACCURACY, maxsplit=1)[0] + judgement(accuracy)


def timed_anew(text: str, measured: str) -> str:
    """docs/performance.md with the same judgement and another `document`."""
    _, found, judged = text.partition(ACCURACY)
    return measured + found + judged


def side_by_side(results: dict[Recording, dict[str, Judged]]) -> str:
    """What the others did on the same recordings, or how to find out."""
    if not results:
        return "Not measured: kiss-icp and evo are missing. Install them with `pip install -e '.[bench]'`.\n"
    return f"""By kiss-icp {version("kiss-icp")} and evo {version("evo")}. Metres, root mean squares in the plane:
evo's absolute pose error after its own alignment, which our own metric has to meet, and its relative error over
{others.STRETCH:g} m. kiss-icp gets each scan as a flat cloud with the times of its beams; it is made for clouds in
three dimensions, and has no inertial data. Its settings, those with the lowest errors on most of these recordings:
{others.SETTINGS}. Two processes measure at once, so that times
are for comparison only.

{tables.others(results)}"""


def document(
    speed: dict[str, dict[str, Any]],
    reading_alone: str,
    starts: str,
    parts: str,
    steps: str,
    growth: str,
    findings: list[Finding],
) -> str:
    """docs/performance.md up to ACCURACY."""
    return f"""# Performance

Written by `make bench` (`python -m benchmarks.performance`); do not edit. More measurements are run by hand:
`python -m benchmarks.page` for what the page costs, `python -m benchmarks.reading BAG...` for how long it takes to
read others, `python -m benchmarks.hour` for [an hour at 40 Hz](long-drives.md#an-hour-at-40-hz),
`python -m benchmarks.latency`, `benchmarks.faults` and `benchmarks.soak` for [a live run](station.md#measured),
and `python -m benchmarks.consistency` for [the filter alone](navigation-filter.md).

Errors are root mean squares in the plane: raw starts at the first pose, aligned takes the best rigid motion out.

## Speed

Measured on {machine()}.

Default settings. Speed is the length of the recording over the wall time of the whole run, reading and decoding
included; the best of several runs, minutes apart.

{tables.speed(speed)}
Median time of each part of a step in microseconds; the update counts only the scans that were written into the
map.

{tables.times(speed)}
Of that, to open and to read the file, without mapping; the best of {reading.RUNS}.

{reading_alone}
How soon the demo `arena` is there, and how long that keeps a core busy: with the kernels compiled before, and on
the first start of all, when the terminal and the page tell how many are. Medians of {start.RUNS} starts without
scipy, which only the `bench` extra brings and numba would load; of one first start.

{starts}
What a step is made of, in the rooms below; medians over the scans, and of those the best of
{kernels.ROUNDS * kernels.LOOKS} looks, some of them a minute apart. A beam evaluation is one endpoint's share of
eqs. (11) and (13).

{parts}
Whole steps, with inertial data and all else that is recorded, each recording in a process of its own: the median
and the best of those looks, and undisturbed, with the fastest of them for each measurement alone. That is a bound:
a recording is the same work every time, but no look was that fast as a whole.

{steps}
How the match and the update of one scan grow: there with other beams, levels and sizes of the first map.

{growth}
## Finding the robot in a saved map

One scan of {BEAMS} beams, sought anywhere in a map that another drive made, {STARTS} times; and scans from another
place, which must not be taken. Not found are scans that fit in several places alike, or too badly to be sure: then
the next scans are tried. Seconds of one search, median / worst. Rooms and arena are the simulated scenes; the site
is made of random walls and boxes.

{tables.findings(findings)}"""


def judgement(accuracy: Accuracy) -> str:
    """docs/performance.md from ACCURACY on."""
    settings = ", ".join(f"`{name}` {str(value).lower()}" for name, value in PAPER.items())
    return f"""{ACCURACY}
Worked out on {machine()}; another processor rounds in another way, after which a drive may come out a little
better or worse.

A raw error of more than {LOST_M:g} m counts as lost. Methods: *full* is the default settings; *paper* is the
paper's own method: {settings}.

## In simulated rooms

Centimetres, median / worst over {len(DRIVE_SEEDS)} seeds: rooms of 30 x 20 m, {DRIVES[0].options.beams} beams,
60 s at up to 1.36 m/s and 65 degrees/s, noise of the UTM-30LX and of a consumer IMU. Every beam leaves at its own
time, but for the exact timing; sway is 15 degrees of roll and pitch at 1.2 Hz. Without an IMU nothing tells the
roll and pitch of a swaying laser, so its scans cannot be put level. Each seed has its own noise and begins at its
own angle to the walls. The last column is yes where every seed holds the goal, else how many do.

{tables.drives(accuracy.drives)}
The same drives begun square to the walls, with an IMU. Many walls then lie along the edges between two cells, for
which a map of cells is worst ([why](accuracy.md#walls-along-the-edges-of-cells)): by cells alone, that is the full
method with `matcher.surfel_weight` 0, and by the full method.

{tables.squares(accuracy.square)}
## In a saved map

Another drive with an IMU, with noise of its own, localises in the map that the first one saved, and changes
nothing in it. Centimetres, median / worst over {len(SEEDS)} seeds: by the cells of that map alone, which is all an
image holds, and with its surfels. What the first drive drew wrong is in both.

{tables.localised(accuracy.localised)}
## A bare corridor

120 m long and 2.4 m wide, walls only, with an IMU, 90 s at 1 m/s; median / worst over {len(SEEDS)} seeds. The
walls do not say how far along the robot is: that direction is open until the far end comes into sight, 30 m before
it, and nothing but the inertial data or the wheels (1 % too fast) can observe it. Sigma is that of the fused pose
at the last such scan. The end is drawn where the robot is estimated to be, so that the covariance has to contain
what was lost on the way there. The goal: not lost, and the covariance contains the error in every scan.

{tables.corridor(accuracy.corridor)}
## Outages

The boat of `littoral` loses its satellites for 30 s behind the island, or its laser for 10 s; median / worst of
{len(OUTAGE_SEEDS)} seeds, in the plane. A jump is what the pose moves from one scan to the next beyond what it
should. The goal: at most 1 m when the satellites return, and no jump.

{tables.outages(accuracy.outages)}
## People, glass and stray beams

A hall of 20 x 12 m, 60 s at 0.8 m/s with an IMU: six people walk to and fro at 0.5 to 1.5 m/s, stop for 10 to 20 s
and go on, and a seventh keeps beside the robot, which stands still for 12 s. A ghost is a cell that is occupied
although nobody has been there for {SIGHT_S:g} s during which beams could pass; the goal is none. Median / worst
over {len(SEEDS)} seeds.

{tables.halls(accuracy.halls)}
What is in the way of the beams must not pull the match. Centimetres, median / worst over the seeds: this hall; one
with panes that return the beams that meet them head on and let most others through, and with walls in their place;
the rooms, with beams that end anywhere before the wall, and with the same beams missing, which no rejection of
outliers could better. Raw errors contain where in its cells the first scan came to lie.

{tables.pulled(in_the_way(accuracy))}
Glass is there for some beams and not for others. Of the cells along the panes that ever were occupied:

{tables.panes(accuracy.glass)}
## On recordings

Metres. The demos are simulated; the others are real but for stage_sim_gt.

{tables.replays(accuracy.replays)}
How consistent the whole is: metres between the first pose and the last (the simulated drives do not end
where they began, see `demo_bags/README.md`), and for a run that comes back the share of the endpoints of its last
{returning.LAST_SCANS} scans that lie on or beside an occupied cell of the map of its first
{returning.FIRST_S:g} s, of those in cells that were known then: doubled walls would lie in free ones. The drives
through the hallway and the kitchen are said to end near their start. Units, handedness and delay of the kitchen's
devices are given by options, and the noise of its accelerometers by `navigation.accel_noise`: with the
default the filter has a sigma of a centimetre where it is two decimetres off, and where the run ends hangs on
trifles.

{tables.returns(accuracy.replays)}
## Side by side with kiss-icp, judged by evo

{side_by_side(accuracy.others)}
## Inertial units alone

Three devices in somebody's hands or on a turntable, with nothing to help the filter but gravity: degrees between
directions of up, medians where the device is at rest.

{tables.inertial(accuracy.inertial)}"""
