"""The command line's flags: every setting from its tree, the topics, a saved map."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, dataclass, field, fields, make_dataclass
from functools import cached_property
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_args, get_origin

import numpy as np
import tyro

from hectorscope.inputs import OptionValue, SourceOptions
from hectorscope.run.settings import Mode, Settings
from hectorscope.run.settings_file import read_file
from slam_core.config import Leaf, Preset, SlamConfig, leaves, preset, with_values
from slam_core.errors import SlamError
from slam_core.measurements import Float64s

if TYPE_CHECKING:
    from slam_core.localization.prior_map import PriorMap  # takes long: loads the compiler

HELP_ALL = "--help-all"
HELP = {"-h", "--help", HELP_ALL}
_experts = ContextVar("_experts", default=True)  # whether there are flags for the expert settings


class _Words(NamedTuple):
    """The help of a flag about the source; default: what holds without it."""

    help: str
    default: str = "found by type"
    metavar: str = "TOPIC"


FARTHEST = 1e5  # metres from the origin of a saved map
_BY_NAME = "found by type and name"
_SOURCE = {
    "scan_topic": _Words("Topic of the laser scans."),
    "imu_topic": _Words("Topic of the inertial data; none leaves it out, as with every topic."),
    "attitude_topic": _Words(
        "Topic of an attitude that somebody else estimated (tf:PARENT>CHILD for tf).",
        "none; without inertial data by tf, if the base leans there",
    ),
    "odometry_topic": _Words("Topic of the wheel odometry."),
    "height_topic": _Words("Topic of the height or the air pressure.", "found by type, a point by its name too"),
    "ground_topic": _Words("Topic of the distance to the ground.", _BY_NAME),
    "magnetic_topic": _Words("Topic of the magnetic field."),
    "gps_topic": _Words("Topic of the satellite fixes."),
    "gps_velocity_topic": _Words("Topic of the velocity by satellites.", _BY_NAME),
    "truth_topic": _Words(
        "Topic of the true poses (tf:PARENT>CHILD for tf): shown and scored, never used.", _BY_NAME
    ),
    "base_frame": _Words("Frame of the robot's base.", "by tf and the messages", "FRAME"),
    "laser_pose": _Words(
        "The laser in the base, metres and radians; overrides tf.",
        "by tf, else at the base",
        "X Y Z ROLL PITCH YAW",
    ),
    "imu_accel_unit": _Words("Unit of the accelerations.", "m/s2", "{m/s2,g,mg}"),
    "imu_gyro_unit": _Words("Unit of the angular rates.", "rad/s", "{rad/s,deg/s}"),
    "imu_inverted": _Words("Which of its vectors the IMU gives with the wrong sign.", "neither", "{accel,gyro}"),
    "imu_rotation": _Words("How the IMU is turned in the base, radians; on top of tf.", "0 0 0", "ROLL PITCH YAW"),
    "imu_delay": _Words("How late the stamps of the inertial data are, seconds.", "0", "SECONDS"),
    "scan_mirrored": _Words(
        "Whether the beams run against the sign of the angle increment.", "false", "{true,false}"
    ),
    "scan_delay": _Words("How late the stamps of the scans are, seconds.", "0", "SECONDS"),
    "scan_sweep": _Words(
        "Time from the first beam of a scan to its last, seconds; negative: the last beam is the first.",
        "by time_increment",
        "SECONDS",
    ),
}
_SWITCH_WORDS = ("true", "false")
_SWITCH: dict[Any, bool] = {"true": True, "false": False}


def optional(help_text: str, default: str = "none", metavar: str | None = None) -> Any:
    """A flag that may be left out, with words for what holds then."""
    return tyro.conf.arg(help=help_text, help_behavior_hint=f"(default: {default})", metavar=metavar)


def _braces(words: Sequence[str]) -> str:
    return "{" + ",".join(words) + "}"


def _one_of(*words: str) -> Any:
    """The type of a flag that takes one of these, which a message lists in this order, or may be left out."""
    spec = tyro.constructors.PrimitiveConstructorSpec[str](
        nargs=1,
        metavar=_braces(words),
        instance_from_str=itemgetter(0),
        is_instance=lambda value: value is None or value in words,
        str_from_instance=lambda value: [str(value)],
        choices=words,
    )
    return Annotated[str | None, spec]


def _flag(leaf: Leaf) -> Any:
    if leaf.param.tier == "expert" and not _experts.get():
        return Annotated[leaf.type | None, tyro.conf.Suppress]
    words = leaf.choices or (_SWITCH_WORDS if leaf.type is bool else ())
    default = str(leaf.value).lower() if leaf.type is bool else leaf.value
    param = leaf.param
    limits = "" if param.low is None else f"{param.low:g} to {param.high:g} {param.unit}".rstrip()
    return Annotated[
        _one_of(*words) if words else leaf.type | None,
        tyro.conf.arg(
            help=param.help,
            metavar=_braces(words) if words else leaf.type.__name__.upper(),
            help_behavior_hint=f"({'; '.join(filter(None, (f'default: {default}', limits)))})",
        ),
    ]


@dataclass
class SettingFlags:
    """What was given on the command line; a group for every group of the settings is added below."""

    preset: Annotated[
        Preset, tyro.conf.arg(help="The defaults, or the paper's method; file and flags override it.")
    ] = "default"
    config: Annotated[Path | None, optional("Settings file (TOML); flags override it.")] = None
    help_all: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        tyro.conf.arg(help="Show this help with the expert settings too, and exit.", help_behavior_hint=""),
    ] = False

    def settings(self) -> Settings:
        """The preset, the file's settings over it, and the flags over these; SlamError for a bad file or value."""
        settings, _ = self._filed
        given = {
            f"{group}.{key}": _SWITCH.get(value, value)
            for group, flags in asdict(self).items()
            if isinstance(flags, dict)
            for key, value in flags.items()
            if value is not None
        }
        return Settings(with_values(settings.start, given), settings.changes)

    def sensors(self) -> Mapping[str, OptionValue]:
        """What the file states of the sensors; SlamError for a bad file."""
        return self._filed[1]

    @cached_property
    def _filed(self) -> tuple[Settings, Mapping[str, OptionValue]]:
        """Of preset and file, which is read once: a pipe gives its text no second time."""
        base = preset(self.preset)
        return read_file(self.config, base) if self.config else (Settings(base), {})


@contextmanager
def help_asked(arguments: Sequence[str]) -> Iterator[Sequence[str]]:
    """The arguments for the parser: help alone where it is asked for, of expert settings only by --help-all."""
    asked = HELP.intersection(arguments)
    before = _experts.set(not asked or HELP_ALL in asked)
    try:
        yield [*(name for name in arguments[:1] if name not in HELP), "--help"] if asked else arguments
    finally:
        _experts.reset(before)


def setting_flags() -> type[SettingFlags]:
    """`SettingFlags` with a flag for each setting, in the groups of the tree."""
    groups: list[Any] = []
    for name, members in groupby(leaves(SlamConfig()), key=lambda leaf: leaf.name.split(".")[0]):
        flags = [(leaf.name.split(".")[1], _flag(leaf), None) for leaf in members]
        group = make_dataclass(f"{name.title()}Flags", flags, namespace={"__doc__": None})
        groups.append((name, group, field(default_factory=group)))
    return make_dataclass("AllSettingFlags", groups, bases=(SettingFlags,))


def _source_flags() -> type[Any]:
    flags: list[Any] = []
    for option in fields(SourceOptions):
        if option.name not in _SOURCE:  # how a robot is reached: cli/station_flags.py
            continue
        meant, _ = get_args(option.type)
        choices = _SWITCH_WORDS if meant is bool else get_args(meant) if get_origin(meant) is Literal else ()
        words = _SOURCE[option.name]
        hint = tyro.conf.arg(
            help=words.help,
            metavar=words.metavar,
            aliases=["--truth"] if option.name == "truth_topic" else [],
            help_behavior_hint=f"(default: {words.default})",
        )
        flags.append((option.name, Annotated[_one_of(*choices) if choices else option.type, hint], None))
    repair = Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        tyro.conf.arg(help="Put right what the sensor check finds: units, signs, mirrored beams, delays."),
    ]
    flags.append(("repair", repair, False))
    return make_dataclass("SourceFlags", flags)


class StartError(SlamError):
    """The flags about a saved map contradict each other."""


@dataclass
class MapFlags:
    """A map that was there before."""

    map: Annotated[
        Path | None,
        optional("Saved map to begin with: a folder that --out left, its map.npz, or a map's yaml file."),
    ] = None
    mode: Annotated[
        Mode | None,
        optional("Make a new map, localise in the saved one, or continue it.", "localise with --map, else map"),
    ] = None
    start: Annotated[
        Literal["origin", "search"] | tuple[float, float, float],
        tyro.conf.arg(
            help="Where the robot is in the saved map: at its origin, anywhere, or at X Y YAW (m, rad).",
            metavar="{origin,search}|X Y YAW",
        ),
    ] = "search"

    def prior_map(self, settings: Settings) -> "PriorMap | None":
        """The saved map, if there is one; SlamError if it cannot be used, or the flags contradict each other."""
        if self.map is None:
            self._check_new()
            return None
        if self.mode == "map":
            raise StartError(f"--mode map makes a new map, {self.map} is a saved one: choose localise or continue")
        from hectorscope.maps.saved_map import load_map  # noqa: PLC0415

        return load_map(self.map, settings.start.map, write=self.mode == "continue", start=self._start())

    def _check_new(self) -> None:
        """StartError for what only a saved map can give."""
        if self.mode not in {None, "map"}:
            raise StartError(f"--mode {self.mode} needs a saved map: give --map DIR")
        if self.start != "search":
            raise StartError(f"--start {self._words()} is a place in a saved map: give --map DIR, or leave it out")

    def _start(self) -> Float64s | None:
        if self.start == "search":
            return None
        start = np.zeros(3) if isinstance(self.start, str) else np.array(self.start)
        if not (np.abs(start) <= FARTHEST).all():  # so, too, where one is no number
            raise StartError(
                f"--start {self._words()} is no pose: give X Y YAW in metres and radians, {FARTHEST:g} at most"
            )
        return start

    def _words(self) -> str:
        return self.start if isinstance(self.start, str) else " ".join(f"{part:g}" for part in self.start)


SettingArgs = Annotated[SettingFlags, tyro.conf.arg(name="", constructor_factory=setting_flags)]
source_flags = _source_flags()
"""With nothing given, `source_flags()`."""
SourceArgs = Annotated[Any, tyro.conf.arg(name="", constructor=source_flags)]
MapArgs = Annotated[MapFlags, tyro.conf.arg(name="")]
ExportArg = Annotated[
    str,
    tyro.conf.arg(
        metavar="NAME,...",
        help="Formats with commas between them; all; or default: npz,pgm,tum,config,metrics,navigation,pictures.",
    ),
]
RelationsArg = Annotated[
    Path | None,
    optional("File of relations (time1 time2 x y z roll pitch yaw, a line each): true motions, which score it."),
]
PublishArg = Annotated[
    tyro.conf.UseAppendAction[tuple[str, ...]],
    tyro.conf.arg(
        metavar="ADDRESS",
        help="Publish map, pose, path, diagnostics and tf: ws://127.0.0.1:PORT for Foxglove,"
        " zenoh://HOST:PORT/DOMAIN or dds://DOMAIN for ROS 2. Give it again for more.",
    ),
]
NoteArg = Annotated[
    tuple[str, ...],
    tyro.conf.arg(metavar="TIME=TEXT", help="Pins a note to a moment of the replay of --export html."),
]


def source_options(flags: Any, settings: SettingFlags | None = None) -> SourceOptions:
    """The flags of `SourceArgs` as the sources take them, over what the settings file states of the sensors."""
    given = asdict(flags)
    del given["repair"]
    given["scan_mirrored"] = _SWITCH.get(given["scan_mirrored"])
    filed = settings.sensors() if settings else {}
    return SourceOptions(**{**filed, **{name: value for name, value in given.items() if value is not None}})
