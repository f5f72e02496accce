"""Opens what the command line names: recordings, streams, and the recordings that come with the program."""

import gc
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

from hectorscope.cli.options import SettingFlags, source_options
from hectorscope.common.paths import exists
from hectorscope.common.resources import resource_folder
from hectorscope.inputs import LinkOptions, OptionValue, Source, SourceError, SourceOptions
from hectorscope.run.report import Report
from hectorscope.sources import addresses, open_source, scheme, suffix_of
from slam_core.errors import SlamError

if TYPE_CHECKING:
    from hectorscope.checks.sensor_check import CheckedSource

Scene = Literal["arena", "littoral", "handheld"]


# Whoever publishes the transforms of the map does not take them for the robot's own when they come back.
OURS: Mapping[str, OptionValue] = MappingProxyType({"own_frame": "map"})


class DemoError(SlamError):
    """The recordings that come with the program are not there."""


def checked(
    uri: str,
    flags: Any,
    settings: SettingFlags,
    sensors: Mapping[str, OptionValue] = MappingProxyType({}),
    link: LinkOptions | None = None,
) -> "CheckedSource":
    """The source behind a path or address, whose sensors are checked as it is read; SlamError for a bad one."""
    from hectorscope.checks.sensor_check import CheckedSource  # noqa: PLC0415

    settings.settings()  # a bad file is named before the source is opened
    stated: dict[str, Any] = dict(sensors)
    options = replace(source_options(flags, settings), **stated, link=link)
    return CheckedSource(partial(open_source, uri), options, repairs=flags.repair)


def streamed(address: str) -> str:
    """The address of a stream; SourceError for a host without a scheme, with the address that is meant."""
    if scheme(address) or "/" in address or suffix_of(address) or exists(Path(address)):
        return address
    raise SourceError(f"{address} is no address: write ws://{address}{'' if ':' in address else ':8765'}")


def recorded(bag: Path) -> Path:
    """The path of a recording; SourceError for the address of a stream, which lost a slash as a path."""
    kind, _, rest = str(bag).partition(":/")
    kinds = {scheme(address) for address in addresses()}
    if kind not in kinds or exists(bag):
        return bag
    address = f"{kind}://{'/' if kind == 'file' and not exists(Path(rest)) else ''}{rest}" if rest else kind
    raise SourceError(f"{address} is a stream and no recording: use `hectorscope live {address}`")


def opened(flags: Any, settings: SettingFlags, path: Path, sensors: Mapping[str, OptionValue]) -> Source:
    """A recording by the flags about the sensors; those that come with the program need none.

    sensors: `SENSOR_OPTIONS` that a kept run states, over the flags.
    """
    if path in demos().values():
        return open_source(str(path), SourceOptions())
    return checked(str(path), flags, settings, sensors)


def demos() -> dict[str, Path]:
    """The recordings that come with the program, by their scenes, in a checkout or in an installed package."""
    folder, scenes = resource_folder("demo_bags"), get_args(Scene)
    places = {scene: [folder / name for name in (f"{scene}.bag", f"{scene}.mcap", scene)] for scene in scenes}
    there = ((scene, next(filter(Path.exists, paths), None)) for scene, paths in places.items())
    return {scene: path for scene, path in there if path is not None}


def demo_bag(scene: Scene) -> Path:
    """The recording of a scene; DemoError if it is not there."""
    if (path := demos().get(scene)) is None:
        raise DemoError(f"the recording of {scene!r} is missing: make one by `hectorscope simulate --help`")
    return path


def get_ready(*report: Report, live: bool = False) -> None:
    """Load or compile the kernels of the first scan, of a stream all; what is compiled is told to a `report`."""
    from hectorscope.run.warmup import warm_up  # noqa: PLC0415

    warm_up(*report, everything=live)
    gc.enable()


def reserved_folder(out: Path | None) -> AbstractContextManager[None]:
    """The folder for results, for this program alone."""
    if out is None:
        return nullcontext()
    from hectorscope.exporters import reserved  # noqa: PLC0415

    return reserved(out)
