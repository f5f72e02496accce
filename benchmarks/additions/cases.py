"""Where the additions are measured: simulated drives, drives with faults, and recordings in variants."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from benchmarks.additions import faults, wheel_faults
from benchmarks.additions.faults import Fault
from benchmarks.cases import DEMOS, DRIVES, LOST_M, REAL, Recording, present
from benchmarks.turned import angle_of, turned
from benchmarks.wheels import with_wheels
from hectorscope.inputs import Item, SourceOptions
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from hectorscope.simulation.scene_people import REST
from hectorscope.sources import open_source
from slam_core.measurements import Imu, LaserScan

SEEDS, VARIANTS = 20, 10
SECONDS = 30.0  # of a drive where nothing asks for more
RANGE_NOISE = 0.003  # m, added to the ranges of a recording's variants
OFF_MAP = 0.2  # share of the last endpoints beside the first walls: the map is doubled
CORRIDOR_LOST_M = 10.0  # of its 120 m
MOST_DROPPED = 5  # scans that a variant leaves out at the start

Tags = frozenset[str]
Load = Callable[[int], list[Item]]


@dataclass(frozen=True, slots=True)
class Case:
    """One row of the document: drives or variants of a recording that differ by their seed alone.

    load: the items of a seed. figure: the column of `benchmarks.additions.runs` that is compared. tags: what there
    is for an addition to act on. settings: what every configuration gets besides. ghosts: the scene is watched for
    cells that people left behind.
    """

    family: str
    name: str
    load: Load
    seeds: int = SEEDS
    figure: str = "raw"
    tags: Tags = frozenset()
    settings: Mapping[str, Any] = field(default_factory=dict)
    ghosts: bool = False
    base: str = ""
    lost: float = LOST_M

    @property
    def graded(self) -> bool:
        """Whether a smaller figure is better; else only whether it is lost counts."""
        return self.figure not in {"start_to_end", "off_map"}


def drive(scene: ScenarioName, options: SceneOptions, *, begun_at_angles: bool = True) -> Load:
    """Drives through a scene; each begins at another angle to the walls."""
    return lambda seed: list(_simulated(scene, replace(options, seed=seed), begun_at_angles))


@lru_cache(maxsize=1)
def _simulated(scene: ScenarioName, options: SceneOptions, begun_at_angles: bool) -> tuple[Item, ...]:
    items = Simulation(scene, options).items()
    return tuple(turned(items, angle_of(options.seed)) if begun_at_angles else items)


def bare(load: Load) -> Load:
    """The same without inertial data."""
    return lambda seed: [item for item in load(seed) if not isinstance(item, Imu)]


def wheeled(load: Load) -> Load:
    """The same with wheels."""
    return lambda seed: list(with_wheels(load(seed), seed))


def faulty(load: Load, fault: Fault) -> Load:
    """The same with a fault."""
    return lambda seed: fault(load(seed), seed)


def recorded(recording: Recording) -> Load:
    """A recording as it is (seed 1), and with some noise and without its first scans."""

    def load(seed: int) -> list[Item]:
        items = open_source(str(recording.path), recording.options).items()
        return list(items if seed == 1 else varied(items, seed))

    return load


def varied(items: Iterable[Item], seed: int) -> Iterator[Item]:
    """The items with noise on every range and without some scans at the start."""
    rng = np.random.default_rng([seed, 24])
    left_out = int(rng.integers(0, MOST_DROPPED + 1))
    for item in items:
        if not isinstance(item, LaserScan):
            yield item
        elif left_out:
            left_out -= 1
        else:
            noise = RANGE_NOISE * rng.standard_normal(len(item.ranges))
            yield replace(item, ranges=(item.ranges + noise).astype(np.float32))


IMU, BARE = frozenset({"imu", "sweep"}), frozenset({"no imu", "unaided", "sweep"})
PEOPLE = SceneOptions(scan_rate=10.0)
WHEELED = frozenset({"imu", "wheels", "sweep"})
BARE_WHEELED = frozenset({"no imu", "wheels", "sweep"})
AFLOAT = IMU | {"aids", "gates"}


def _pair(
    base: str, load: Load, with_imu: Tags, *names: str, family: str = "scenes", **details: Any
) -> Iterator[Case]:
    """A drive with inertial data, and without."""
    kept = with_imu & {"aids", "sweep", "large", "noisy"}
    name = names[0] if names else base
    yield Case(family, name, load, tags=with_imu, base=base, **details)
    yield Case(f"{family} without IMU", name, bare(load), tags=kept | {"no imu", "unaided"}, base=base, **details)


def _rooms() -> Iterator[Case]:
    for each in DRIVES:
        load = drive("rooms", replace(each.options, duration=SECONDS))
        yield from _pair(each.name, load, IMU if each.options.beam_timing else IMU - {"sweep"}, family="rooms")


def _begun() -> Iterator[Case]:
    """Recordings that begin in motion."""
    for name, options in (
        ("in a turn, 40 Hz", SceneOptions(begin=6.25, duration=6.25 + SECONDS)),
        ("in a turn, 5 Hz, sway", replace(DRIVES[-1].options, begin=6.25, duration=6.25 + SECONDS)),
        ("at a constant velocity, 10 Hz, sway", replace(DRIVES[3].options, begin=8.5, duration=8.5 + SECONDS)),
    ):
        yield Case("begun", name, drive("rooms", options), tags=IMU | {"begun"})


def _scenes() -> Iterator[Case]:
    moderate = SceneOptions(scan_rate=20.0, duration=SECONDS)
    yield from _pair("arena", drive("arena", moderate), IMU)
    yield from _pair("handheld", drive("handheld", moderate), IMU)
    afloat = drive("littoral", SceneOptions(scan_rate=10.0), begun_at_angles=False)
    yield from _pair("littoral", afloat, AFLOAT | {"large"})
    people, hall = drive("people", PEOPLE, begun_at_angles=False), drive("people", replace(PEOPLE, people=False))
    yield Case("scenes", "people", people, tags=IMU, ghosts=True, base="people")
    yield Case("scenes without IMU", "people", bare(people), tags=BARE, base="people")
    driven = faulty(wheeled(bare(people)), faults.nearsighted(4.0))
    yield Case("scenes without IMU", "people, 4 m, with wheels", driven, tags=BARE_WHEELED)
    yield Case("scenes", "the hall without people", hall, tags=IMU, base="hall")
    yield Case("scenes", "glass", drive("glass", replace(moderate, scan_rate=10.0)), tags=IMU, base="glass")
    slow = drive("rooms", SceneOptions(scan_rate=10.0, duration=SECONDS))
    yield from _pair("stray beams, 30 %, 10 Hz", faulty(slow, faults.stray_beams), IMU)
    yield from _pair("noise of 1 % of the range, 10 Hz", faulty(slow, faults.noisy(0.01)), IMU | {"noisy"})


def _corridor() -> Iterator[Case]:
    along = drive("corridor", SceneOptions(scan_rate=10.0), begun_at_angles=False)
    large = frozenset({"large"})
    for name, load, tags in (
        ("with IMU", along, IMU),
        ("with IMU and wheels", wheeled(along), WHEELED),
        ("with wheels, no IMU", wheeled(bare(along)), BARE_WHEELED),
        ("scans alone", bare(along), BARE),
    ):
        yield Case("corridor", name, load, tags=tags | large, base="corridor", lost=CORRIDOR_LOST_M)


def _faults() -> Iterator[Case]:
    rooms = drive("rooms", SceneOptions(duration=20.0, beams=361, scan_rate=20.0))
    for name, fault in (
        ("no scan for 1.5 s", faults.without_scans(faults.AT_S, faults.AT_S + 1.5)),
        ("ten scans of noise", faults.broken_scans),
        ("carried away", faults.carried_away),
    ):
        yield from (
            replace(case, name=name, base="faults")
            for case in _pair(name, faulty(rooms, fault), IMU, family="faults", figure="end")
        )
    for name, fault in (
        ("wild wheels", wheel_faults.wild_wheels),
        ("spinning wheels", wheel_faults.spinning_wheels),
    ):
        wheels, alone = faulty(wheeled(rooms), fault), faulty(wheeled(bare(rooms)), fault)
        yield Case("faults", name, wheels, tags=WHEELED | {"gates"}, base="faults")
        yield Case("faults without IMU", name, alone, tags=BARE_WHEELED, base="faults")
    walk = drive("handheld", SceneOptions(duration=SECONDS, beams=361, scan_rate=10.0))
    for name, fault in (("wild heights", faults.wild_heights), ("heights jump by 3 m", faults.raised_heights)):
        tags = IMU | {"wild heights", "gates"}
        yield Case("faults", name, faulty(walk, fault), tags=tags, figure="height", base="heights")
    yield Case(
        "faults", "no barometer", faulty(walk, faults.no_heights), tags=IMU, figure="height", base="heights"
    )
    begin, length = REST
    rest = drive("people", replace(PEOPLE, beams=361, people=False))
    pause = faults.without_scans(begin + 1.5, begin + length - 0.5)
    yield Case("faults", "at rest without scans", faulty(rest, pause), tags=IMU, figure="end", base="rest")
    yield from _outages()


def _outages() -> Iterator[Case]:
    afloat = drive("littoral", SceneOptions(scan_rate=10.0, gps_outage=0.0), begun_at_angles=False)
    blind = faulty(afloat, faults.without_scans(25.0, 35.0))
    near_metal = faulty(afloat, faults.without_scans(15.0, 27.0))
    jumping = faulty(blind, faults.jumping_satellites)
    no_satellites = {"aiding.gps": False}
    for name, load, settings in (
        ("no scan for 10 s", blind, {}),
        ("no scan, no satellites, no compass", blind, {**no_satellites, "aiding.compass": False}),
        ("no scan, satellites jump by 50 m", jumping, {}),
        ("no scan beside metal, no satellites", near_metal, no_satellites),
        ("carried 8 s on, no scan for 20 s", faulty(afloat, faults.carried_on), {}),
    ):
        yield Case("outages", name, load, tags=AFLOAT, figure="end", settings=settings, base="outages")
    tags = BARE | {"aids"}
    yield Case("outages", "no scan for 10 s, no IMU", bare(blind), tags=tags, figure="end", base="outages")


_KITCHEN = REAL[6]
_KITCHEN_ALONE = Recording("mumble kitchen_1, scans alone", _KITCHEN.path, options=SourceOptions(imu_topic="none"))
_MIT_ALONE = replace(
    REAL[3], name="mit_csail, scans alone", options=replace(REAL[3].options, odometry_topic="none")
)


def _recordings() -> Iterator[Case]:
    for demo in DEMOS:
        tags = AFLOAT | {"large"} if "littoral" in demo.name else IMU
        yield Case("recordings", demo.name, recorded(demo), 5, "aligned", tags)
    scans, wheels = BARE, BARE_WHEELED
    table: tuple[tuple[Recording, str, Tags, int], ...] = (
        (REAL[0], "aligned", scans, VARIANTS),
        (REAL[1], "aligned", scans, VARIANTS),
        (REAL[2], "aligned", scans, VARIANTS),
        (REAL[3], "aligned", wheels, 5),
        (_MIT_ALONE, "aligned", scans, 5),
        (REAL[4], "start_to_end", scans, VARIANTS),
        (_KITCHEN, "start_to_end", IMU, VARIANTS),
        (_KITCHEN_ALONE, "start_to_end", scans, VARIANTS),
        (REAL[5], "off_map", scans, VARIANTS),
    )
    for recording, figure, tags, seeds in table:
        if present((recording,)):
            limit = OFF_MAP if figure == "off_map" else LOST_M
            yield Case("recordings", recording.name, recorded(recording), seeds, figure, tags,
                       dict(recording.settings), lost=limit)  # fmt: skip


def cases() -> list[Case]:
    """All of them; the recordings that lie beside the project where they are there."""
    return [*_recordings(), *_faults(), *_corridor(), *_scenes(), *_rooms(), *_begun()]
