"""The cases of the ensembles: recordings, simulated scenes, and what goes wrong in them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from benchmarks.additions.cases import bare, faulty, wheeled
from benchmarks.additions.faults import (
    Fault,
    blind,
    covered,
    crowded,
    ending,
    held_up,
    interrupted,
    noisy,
    repeated,
    seen_ahead,
    seen_within,
    two_lasers,
    unechoed,
)
from benchmarks.additions.imu_faults import hit, knocked, spiked
from benchmarks.additions.wheel_faults import slipping, spinning, stuck
from benchmarks.broken import Break
from benchmarks.cases import DEMOS, FURTHER, REAL, Recording, present
from benchmarks.circuits import Shape, circuit
from benchmarks.clock_faults import BOOTED_S, apart, recorded_by
from hectorscope.inputs import Item, SourceOptions
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from hectorscope.sources import open_source
from slam_core.measurements import Height, Imu, LaserScan

BLIND_S = 23.6  # s from the start, when something ceases: the walk is about to enter a corridor
EVERYTHING = (LaserScan, Imu, Height)  # that a scene sends

# Seconds without scans, and the scene.
BLIND: tuple[tuple[float, ScenarioName], ...] = (
    (4.0, "handheld"),
    (6.0, "handheld"),
    (8.0, "handheld"),
    (8.0, "arena"),
    (10.0, "arena"),
    (10.0, "handheld"),
    (10.0, "rooms"),
    (8.0, "littoral"),
    (10.0, "littoral"),
)
# Seconds without any data, as over a link that breaks, the scene, and whether there is an IMU.
SILENT: tuple[tuple[float, ScenarioName, bool], ...] = (
    (2.0, "arena", True),
    (4.0, "arena", True),
    (10.0, "arena", True),
    (10.0, "arena", False),
    (3.0, "handheld", True),
    (10.0, "handheld", True),
    (10.0, "rooms", True),
    (10.0, "people", True),
)
# The same while the map is small; the last number is seconds from the start.
EARLY: tuple[tuple[float, ScenarioName, bool, float], ...] = (
    (5.0, "arena", True, 10.0),
    (5.0, "arena", False, 10.0),
    (7.0, "arena", True, 16.0),
    (5.0, "rooms", True, 10.0),
)
# Seconds of inertial data before the first scan, while the robot drives, and the scene.
LATE: tuple[tuple[float, ScenarioName], ...] = (
    (5.0, "rooms"),
    (10.0, "rooms"),
    (5.0, "handheld"),
    (10.0, "handheld"),
    (10.0, "arena"),
    (30.0, "littoral"),
)
STAMPED = held_up((LaserScan,), 1.0, 5.0, stamped=True)
ALL_STAMPED = held_up(EVERYTHING, 1.0, 5.0, stamped=True)
TARDY = held_up((LaserScan,), 3.0, 10.0, stamped=False)
# What happens again and again, whether there is an IMU, and the scenes.
AGAIN: tuple[tuple[str, Fault, bool, tuple[ScenarioName, ...]], ...] = (
    ("no data for 1 s in 6", interrupted(1.0, 6.0), True, ("arena", "rooms", "handheld", "littoral")),
    ("no data for 1 s in 6", interrupted(1.0, 6.0), False, ("arena", "rooms")),
    ("no data for 2 s in 10", interrupted(2.0, 10.0), True, ("arena", "rooms", "littoral")),
    ("scans of 1 s in 5 stamped together", STAMPED, True, ("arena", "rooms", "handheld", "littoral")),
    ("scans of 1 s in 5 stamped together", STAMPED, False, ("arena", "rooms")),
    ("data of 1 s in 5 stamped together", ALL_STAMPED, True, ("arena", "rooms", "handheld", "littoral")),
    ("scans up to 3 s late in 10", TARDY, True, ("rooms", "handheld", "littoral")),
    ("covered for 2 s in 10", covered(2.0, 10.0), True, ("arena", "rooms", "handheld", "littoral")),
    ("covered for 2 s in 10", covered(2.0, 10.0), False, ("arena", "rooms")),
    ("covered for 5 s in 15", covered(5.0, 15.0), True, ("arena", "rooms")),
    ("4 people around for 4 s in 10", crowded(4, 4.0, 10.0), True, ("arena", "rooms")),
    ("4 people around for 4 s in 10", crowded(4, 4.0, 10.0), False, ("arena", "rooms")),
    ("scans repeated for 2 s in 10", repeated(LaserScan, 2.0, 10.0), True, ("arena", "rooms", "people")),
    ("scans repeated for 5 s in 15", repeated(LaserScan, 5.0, 15.0), True, ("rooms", "people")),
    ("scans repeated for 0.5 s in 6", repeated(LaserScan, 0.5, 6.0), False, ("arena", "rooms")),
    (
        "IMU repeats itself for 3 s in 12",
        repeated(Imu, 3.0, 12.0),
        True,
        ("arena", "rooms", "handheld", "littoral"),
    ),
    ("1 of 200 IMU samples a spike", spiked(0.005, 1), True, ("rooms", "people", "handheld", "littoral")),
    ("IMU with spikes of 2 samples", spiked(0.005, 2), True, ("rooms", "people", "handheld", "littoral")),
    ("IMU with spikes of 3 samples", spiked(0.005, 3), True, ("rooms", "littoral")),
    ("knocked round every 2 s", knocked(2.0, 4.0), True, ("arena", "handheld")),
    ("hit every 2 s, IMU of 2 g", hit(2.0), True, ("rooms", "people", "handheld", "littoral")),
    ("8 m sent without a return", ending(8.0), True, ("rooms", "handheld")),
    ("8 m sent without a return", ending(8.0), False, ("rooms", "people", "glass")),
    ("noise of 1 % of the range", noisy(0.01), True, ("rooms", "people", "handheld", "littoral")),
    ("noise of 1 % of the range", noisy(0.01), False, ("rooms", "people", "glass")),
    ("noise of 2 % of the range", noisy(0.02), True, ("rooms", "people")),
    ("30% of the beams unseen", unechoed(0.3), True, ("corridor", "handheld")),
    ("70% of the beams unseen", unechoed(0.7), True, ("corridor", "handheld")),
    ("120 degrees ahead unseen", blind(120.0), True, ("arena", "rooms", "handheld", "littoral", "corridor")),
)

# How clocks are apart, and the scenes.
CLOCKS: tuple[tuple[str, Break, tuple[ScenarioName, ...]], ...] = (
    ("laser's clock 30 s behind", apart("ranges", -30.0), ("arena", "rooms", "handheld", "littoral")),
    ("IMU's clock 1 s ahead", apart("linear_acceleration", 1.0), ("rooms", "handheld")),
    (
        "IMU's clock from its start, and fast",
        apart("linear_acceleration", BOOTED_S, 1e-4),
        ("arena", "rooms", "handheld", "littoral"),
    ),
    (
        "IMU's clock set by 40 s",
        apart("linear_acceleration", 40.0, from_s=BLIND_S),
        ("arena", "rooms", "handheld"),
    ),
)

# What wheels do, and the scenes: with a laser that sees so many metres far, and with one that sees all.
NEAR: tuple[tuple[float, str, Fault | None, tuple[ScenarioName, ...]], ...] = (
    (4.0, "with wheels", None, ("rooms", "people", "offices")),
    (6.0, "with wheels", None, ("people",)),
    (4.0, "wheels that slip in turns", slipping(0.5, 3.0), ("rooms", "people", "offices")),
)
FAR: tuple[tuple[str, Fault, tuple[ScenarioName, ...]], ...] = (
    ("wheels stuck for 2 s in 10", stuck(2.0, 10.0), ("rooms", "people", "offices")),
    ("wheels that spin for 2 s in 10", spinning(2.0, 10.0), ("rooms", "people", "offices")),
)

# A small robot with wheels: a laser of 5 Hz and a beam a degree, its reach (metres); the scene, the part of its
# speed, and whether there is an IMU.
SMALL_REACH = 3.5
SMALL: tuple[tuple[ScenarioName, float, bool], ...] = (
    ("people", 0.3, False),
    ("people", 0.3, True),
    ("rooms", 0.16, False),
    ("offices", 0.4, False),
)

# A depth camera whose middle row is sent as scans: metres and degrees that it sees.
DEPTH_REACH, DEPTH_VIEW = 5.0, 60.0

# Two lasers on one topic, of which each sees half of the view; with an IMU or by them alone.
TWO_LASERS: tuple[tuple[ScenarioName, bool], ...] = (
    ("rooms", True), ("handheld", True), ("arena", True), ("rooms", False), ("people", False), ("glass", False),
)  # fmt: skip

# Circuits of corridors that a car with a laser alone races through, at so many m/s.
RACED: tuple[tuple[Shape, float], ...] = (("square", 2.0), ("square", 4.0), ("winding", 2.0), ("winding", 4.0))

TWICE_A_SECOND: tuple[ScenarioName, ...] = ("rooms", "handheld", "arena")

Load = Callable[[int], list[Item]]


@dataclass(frozen=True, slots=True)
class Case:
    """load: the items of a seed. seeded: each variant is a simulation of its own."""

    name: str
    load: Load
    seeded: bool = False
    settings: Mapping[str, Any] = field(default_factory=dict)


def recorded(recording: Recording) -> Case:
    """A recording as a case."""
    source = partial(open_source, str(recording.path), recording.options)
    return Case(recording.name, lambda _: list(source().items()), settings=dict(recording.settings))


def simulated(name: str, scene: ScenarioName, options: SceneOptions, *, imu: bool) -> Case:
    """A scene as a case; without an IMU it is measured by the laser alone."""
    load: Load = lambda seed: list(Simulation(scene, replace(options, seed=seed)).items())  # noqa: E731
    return Case(f"{name}{'' if imu else ', laser alone'}", load if imu else bare(load), seeded=True)


def driven(what: str, fault: Fault | None, scene: ScenarioName) -> Case:
    """A scene that wheels measure besides the laser."""
    corridors = SceneOptions(scan_rate=10.0, beams=451, duration=120.0)
    options = corridors if scene == "offices" else SceneOptions(scan_rate=10.0)
    load = wheeled(simulated(scene, scene, options, imu=False).load)
    return Case(f"{scene}, {what}", faulty(load, fault) if fault else load, seeded=True)


def of_small_robot(scene: ScenarioName, speed: float, *, imu: bool) -> Case:
    """A scene that a small robot with wheels drives through slowly."""
    beams = 181 if scene == "offices" else 271
    options = SceneOptions(scan_rate=5.0, beams=beams, speed=speed, duration=90.0)
    case = within(SMALL_REACH, simulated(scene, scene, options, imu=imu))
    load = wheeled(case.load)
    return replace(case, name=f"{scene}, small robot with wheels{' and IMU' if imu else ''}", load=load)


def by_depth_camera(scene: ScenarioName, *, wheels: bool, imu: bool) -> Case:
    """A scene that a robot sees with a depth camera, and measures with wheels, an IMU or both besides."""
    case = within(DEPTH_REACH, simulated(scene, scene, SceneOptions(scan_rate=30.0), imu=imu))

    def load(seed: int) -> list[Item]:
        return [seen_ahead(DEPTH_VIEW, i) if isinstance(i, LaserScan) else i for i in case.load(seed)]

    sensors = " and ".join(name for name, there in (("wheels", wheels), ("IMU", imu)) if there)
    return replace(case, name=f"{scene}, depth camera with {sensors}", load=wheeled(load) if wheels else load)


def raced(shape: Shape, speed: float) -> Case:
    """A circuit as a case."""
    return Case(f"{shape} circuit, {speed:g} m/s, laser alone", partial(circuit, shape, speed), seeded=True)


def within(reach: float, case: Case) -> Case:
    """The same with a laser that sees so many metres far."""
    load: Load = lambda seed: [seen_within(reach, item) for item in case.load(seed)]  # noqa: E731
    return replace(case, name=f"{case.name}, {reach:g} m", load=load)


def without(seconds: float, what: str, kinds: tuple[type, ...], case: Case, begin: float = BLIND_S) -> Case:
    """The same without measurements of these kinds for so long, from so many seconds on."""

    def load(seed: int) -> list[Item]:
        items = case.load(seed)
        first, last = (items[0].stamp_ns + round(t * 1e9) for t in (begin, begin + seconds))
        return [item for item in items if not (isinstance(item, kinds) and first <= item.stamp_ns < last)]

    early = f" from {begin:g} s" if begin != BLIND_S else ""
    return replace(case, name=f"{case.name}, no {what} for {seconds:g} s{early}", load=load)


def damaged(what: str, fault: Fault, case: Case) -> Case:
    """The same with something that goes wrong in it."""
    return replace(case, name=f"{case.name}, {what}", load=lambda seed: fault(case.load(seed), seed))


def clocked(what: str, broken: Break, scene: ScenarioName, options: SceneOptions) -> Case:
    """A scene whose recording has stamps by clocks that are apart."""
    return Case(f"{scene}, {what}", partial(recorded_by, broken, scene, options), seeded=True)


def cases() -> list[Case]:
    """All of them; the recordings that lie beside the project where they are there."""
    offices = SceneOptions(scan_rate=4.7, beams=361)
    coarse = replace(offices, beams=181, duration=600.0)
    fast = replace(offices, scan_rate=10.0, speed=1.5, duration=600.0)
    worse, coarse_worse = (replace(each, noise=3.0, duration=300.0) for each in (offices, coarse))
    small = SceneOptions(scan_rate=10.0, beams=451)
    cheap = replace(offices, scan_rate=5.5, duration=300.0)
    slow, moderate = SceneOptions(scan_rate=5.0), SceneOptions(scan_rate=20.0)
    mit_alone = replace(
        REAL[3], name="mit_csail, laser alone", options=replace(REAL[3].options, odometry_topic="none")
    )
    kitchen_alone = Recording(
        "mumble kitchen_1, laser alone", REAL[6].path, options=SourceOptions(imu_topic="none")
    )
    return [
        simulated("offices, 20 min", "offices", offices, imu=False),
        simulated("offices, 10 min, 1 degree", "offices", coarse, imu=False),
        simulated("offices, 10 min, 1.5 m/s", "offices", fast, imu=False),
        simulated("offices, 5 min, 3 times the noise", "offices", worse, imu=False),
        simulated("offices, 5 min, a degree, 3 times the noise", "offices", coarse_worse, imu=False),
        within(8.0, simulated("offices, 5 min", "offices", replace(small, duration=300.0), imu=False)),
        within(12.0, simulated("offices, 5 min, 5.5 Hz", "offices", cheap, imu=False)),
        within(8.0, simulated("offices, 5 min, 5.5 Hz", "offices", cheap, imu=False)),
        within(8.0, simulated("offices, 5 min, 5.5 Hz", "offices", cheap, imu=True)),
        within(8.0, simulated("people", "people", small, imu=False)),
        *(within(6.0, simulated("people", "people", moderate, imu=imu)) for imu in (True, False)),
        *(
            without(seconds, "scans", (LaserScan,), simulated(scene, scene, moderate, imu=True))
            for seconds, scene in BLIND
        ),
        *(
            without(seconds, "scans", (LaserScan,), simulated(scene, scene, moderate, imu=True), 0.0)
            for seconds, scene in LATE
        ),
        *(
            without(seconds, "data", EVERYTHING, simulated(scene, scene, moderate, imu=imu), begin)
            for seconds, scene, imu, begin in (*((*each, BLIND_S) for each in SILENT), *EARLY)
        ),
        *(
            damaged(what, fault, simulated(scene, scene, moderate, imu=imu))
            for what, fault, imu, scenes in AGAIN
            for scene in scenes
        ),
        *(clocked(what, broken, scene, moderate) for what, broken, scenes in CLOCKS for scene in scenes),
        *(within(reach, driven(what, fault, scene)) for reach, what, fault, scenes in NEAR for scene in scenes),
        *(driven(what, fault, scene) for what, fault, scenes in FAR for scene in scenes),
        *(of_small_robot(scene, speed, imu=imu) for scene, speed, imu in SMALL),
        by_depth_camera("rooms", wheels=True, imu=False),
        by_depth_camera("rooms", wheels=True, imu=True),
        by_depth_camera("rooms", wheels=False, imu=True),
        by_depth_camera("arena", wheels=False, imu=True),
        *(
            damaged("two lasers", two_lasers, simulated(scene, scene, replace(slow, scan_rate=10.0), imu=imu))
            for scene, imu in TWO_LASERS
        ),
        *(raced(shape, speed) for shape, speed in RACED),
        *(recorded(each) for each in present((*DEMOS, *REAL, *FURTHER, mit_alone, kitchen_alone))),
        *(simulated(f"{scene}, 2 Hz", scene, replace(slow, scan_rate=2.0), imu=True) for scene in TWICE_A_SECOND),
        simulated("rooms, 5 Hz", "rooms", slow, imu=True),
        simulated("rooms, 5 Hz", "rooms", slow, imu=False),
        simulated("arena", "arena", moderate, imu=False),
        simulated("people", "people", replace(moderate, scan_rate=10.0), imu=False),
        simulated("glass", "glass", replace(moderate, scan_rate=10.0), imu=False),
    ]
