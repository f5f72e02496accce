"""The command line: hectorscope demo, view, live, serve, drive, run, sweep, inspect, simulate."""

import gc
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from hectorscope.cli.interruption import INTERRUPTED, ended_by_interruption
from hectorscope.cli.opening import OURS, Scene, checked, demo_bag, opened, recorded, streamed
from hectorscope.cli.options import (
    ExportArg,
    MapArgs,
    NoteArg,
    PublishArg,
    RelationsArg,
    SettingArgs,
    SourceArgs,
    help_asked,
    optional,
    source_flags,
    source_options,
)
from hectorscope.cli.page_flags import AddressArgs, PageArgs
from hectorscope.cli.simulate import simulate_command
from hectorscope.cli.station_flags import StationArgs
from hectorscope.cli.sweep_flags import SweepArgs
from hectorscope.common.kernel_cache import cache_places, keep_compiled
from hectorscope.common.terminal import printable
from hectorscope.inputs import SourceOptions
from hectorscope.sources import open_source
from slam_core.errors import SlamError

# What takes long to import (viser, numba, rosbags) is imported by the command that needs it: help comes at once.

BAG = "A .bag, .mcap, .db3, a rosbag2 folder, or a CARMEN or tinySLAM log."
Bag = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(help=BAG)]

ADDRESS = (
    "A Foxglove bridge (ws://HOST:PORT or wss://HOST:PORT), a rosbridge (rosbridge://HOST:PORT or"
    " rosbridges://HOST:PORT), a Zenoh router of ROS 2 (zenoh://HOST:PORT/DOMAIN), a DDS domain of ROS 2"
    " (dds://DOMAIN), an MCAP that is being written (file://PATH), or - for one on the standard input."
)

MISTAKE = 2


class EmptyArgumentError(SlamError):
    """A flag without its value."""


class SweepError(SlamError):
    """A sweep is to be run and to be shown."""


def demo(
    scene: Annotated[Scene, tyro.conf.Positional, tyro.conf.arg(help="Which of the paper's scenarios.")] = "arena",
    *,
    settings: SettingArgs,
    saved: MapArgs,
    page: PageArgs,
) -> int:
    """Show one of the simulated recordings that come with the program."""
    shown = open_source(str(demo_bag(scene)), SourceOptions())
    return _show(shown, settings, saved, page, partial(opened, source_flags(), settings))


def view(
    bag: Annotated[
        Path | None, tyro.conf.Positional, tyro.conf.arg(help=f"{BAG} Without one, choose on the page.")
    ] = None,
    *,
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
    page: PageArgs,
) -> int:
    """Show a recording in the browser; the page can open others."""
    by_path = partial(opened, source, settings)
    return _show(by_path(recorded(bag), {}) if bag else None, settings, saved, page, by_path, bag)


def live(
    address: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="ADDRESS", help=f"{ADDRESS} Without one, robots are looked for and listed."),
    ] = None,
    *,
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
    page: PageArgs,
    station: StationArgs,
) -> int:
    """Show the stream of a running robot in the browser."""
    if address is None:
        from hectorscope.cli.discovery import look, told  # noqa: PLC0415

        print(told(look()))
        return 0
    shown = checked(streamed(address), source, settings, OURS if station.publish else {}, link=station.link())
    options = station.options(address, source_options(source, settings))
    return _show(shown, settings, saved, page, partial(opened, source, settings), None, options)


def serve(
    address: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="ADDRESS", help=ADDRESS)],
    *,
    publish: PublishArg = (),
    out: Annotated[Path | None, optional("Folder for the results of `run`, saved at the end.")] = None,
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
) -> int:
    """Follow a running robot without a page, as a node: its results are published, and saved at the end."""
    from hectorscope.cli.node import follow  # noqa: PLC0415

    return follow(checked(streamed(address), source, settings, OURS), settings, saved, publish, out)


def drive(
    world: Annotated[
        Literal["rooms", "arena", "corridor", "offices", "glass"],
        tyro.conf.Positional,
        tyro.conf.arg(help="Through which world of the simulator."),
    ] = "rooms",
    *,
    seed: Annotated[int, tyro.conf.arg(help="Seed of the noise.")] = 1,
    settings: SettingArgs,
    saved: MapArgs,
    page: PageArgs,
) -> int:
    """Show a simulated robot that is driven from the page, by keys or a joystick."""
    from hectorscope.simulation.drive_source import DriveSource  # noqa: PLC0415

    shown = DriveSource(world, seed)
    return _show(shown, settings, saved, page, partial(opened, source_flags(), settings))


def run(
    bag: Bag,
    *,
    out: Annotated[Path, tyro.conf.arg(help="Folder for the results.")],
    export: ExportArg = "default",
    relations: RelationsArg = None,
    note: NoteArg = (),
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
) -> int:
    """Process a recording as fast as it goes; leave trajectory, map, settings and figures.

    Exits with 3 when the pose is lost at the end or in half of the scans, or half of the scans cannot be used.
    """
    from hectorscope.cli.headless import process  # noqa: PLC0415

    return process(recorded(bag), out, export, relations, note, settings, saved, source)


def sweep(
    bags: Annotated[
        tuple[str, ...],
        tyro.conf.Positional,
        tyro.conf.arg(metavar="BAG...", help="Recordings, as paths or addresses (s3://..., with a * for many)."),
    ] = (),
    *,
    out: Annotated[Path | None, optional("Folder for the table; what it has already is not run again.")] = None,
    show: Annotated[Path | None, optional("Folder of a sweep: show its page, and run nothing.")] = None,
    flags: SweepArgs,
    settings: SettingArgs,
    source: SourceArgs,
    address: AddressArgs,
) -> None:
    """Run many recordings with many settings, a row of a table each; --show looks at it.

    Exits with 0 whatever became of single runs: the table says that.
    """
    from hectorscope.cli import sweep as sweeps  # noqa: PLC0415

    if show is not None:
        if bags or out is not None:
            raise SweepError("--show looks at a sweep and runs nothing: leave recordings and --out out")
        sweeps.show(show, address)
    else:
        sweeps.do(bags, out, flags, settings, source)


def inspect(bag: Bag, *, source: SourceArgs) -> None:
    """List what a recording contains and what each topic would be used for."""
    from hectorscope.checks.inspect import inspect_bag  # noqa: PLC0415

    print(inspect_bag(recorded(bag), source_options(source), repair=source.repair))


def _show(*what: Any) -> int:
    """Serve the page; the exit code, as nothing but an interruption ends that."""
    from hectorscope.cli.page import show  # noqa: PLC0415

    show(*what)
    return INTERRUPTED


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit code: 2 for a mistake, with a line on stderr; 3: lost; 130: interrupted."""
    with ended_by_interruption():
        return _exit_code(sys.argv[1:] if arguments is None else arguments)


def _exit_code(arguments: Sequence[str]) -> int:
    arguments = arguments or ["view"]
    if list(arguments) == ["--version"]:
        print(f"hectorscope {version('hectorscope')}")
        return 0
    gc.disable()  # while the libraries come: it would go through all of them again and again
    commands: dict[str, Callable[..., Any]] = {
        "demo": demo,
        "view": view,
        "live": live,
        "serve": serve,
        "drive": drive,
        "run": run,
        "sweep": sweep,
        "inspect": inspect,
        "simulate": simulate_command(wanted="simulate" in arguments[:1]),
    }
    try:
        with help_asked(arguments) as given:
            _refuse_empty(given)
            keep_compiled(*cache_places())
            code = tyro.extras.subcommand_cli_from_dict(
                commands,
                prog="hectorscope",
                description="Hector SLAM on a recording or a live robot, with every step shown in the browser."
                " --version alone prints the version.",
                args=given,
                config=(tyro.conf.DisallowNone, tyro.conf.HelptextFromCommentsOff),
            )
    except SlamError as error:
        print(f"hectorscope: {printable(' '.join(str(error).split()))}", file=sys.stderr)
        return MISTAKE
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    else:
        return int(code or 0)
    finally:
        gc.enable()
    return 0


def _refuse_empty(arguments: Sequence[str]) -> None:
    """An empty value is a variable of a script that was not set; as a path it would be the present folder."""
    for at, argument in enumerate(arguments):
        if not argument or (argument.startswith("--") and argument.endswith("=")):
            name = argument or arguments[max(0, at - 1)]
            raise EmptyArgumentError(f"the value of {name.rstrip('=')} is empty: give one, or leave the flag out")


if __name__ == "__main__":
    sys.exit(main())
