"""The command line: hectorscope demo, view, live, run, inspect, simulate."""

import gc
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from hectorscope.cli.interruption import delivered_later, ended_by_interruption, undisturbed
from hectorscope.cli.options import (
    ExportArg,
    MapArgs,
    MapFlags,
    NoteArg,
    PageArgs,
    PageFlags,
    SettingArgs,
    SettingFlags,
    SourceArgs,
    help_asked,
    source_options,
)
from hectorscope.common.kernel_cache import cache_places, keep_compiled
from hectorscope.common.resources import resource_folder
from hectorscope.common.terminal import printable
from hectorscope.inputs import Source, SourceOptions
from hectorscope.run.report import Report
from hectorscope.sources import open_source
from slam_core.errors import SlamError

if TYPE_CHECKING:
    from hectorscope.checks.sensor_check import CheckedSource

# What takes long to import (viser, numba, rosbags) is imported by the command that needs it: help comes at once.

Scene = Literal["arena", "littoral", "handheld"]
Bag = Annotated[
    Path,
    tyro.conf.Positional,
    tyro.conf.arg(help="A .bag, .mcap, .db3, a rosbag2 folder, or a CARMEN or tinySLAM log."),
]

MISTAKE = 2
LOST = 3
LOST_SHARE = 0.5  # of the scans of a run: so many without a known pose make its map of no use
INTERRUPTED = 130


class EmptyArgumentError(SlamError):
    """A flag without its value."""


class DemoError(SlamError):
    """The recordings that come with the program are not there."""


def demo(
    scene: Annotated[Scene, tyro.conf.Positional, tyro.conf.arg(help="Which of the paper's scenarios.")] = "arena",
    *,
    settings: SettingArgs,
    saved: MapArgs,
    page: PageArgs,
) -> None:
    """Show one of the simulated recordings that come with the program."""
    _show(open_source(str(demo_bag(scene)), SourceOptions()), settings, saved, page)


def view(bag: Bag, *, settings: SettingArgs, saved: MapArgs, source: SourceArgs, page: PageArgs) -> None:
    """Show a recording in the browser."""
    _show(_checked(str(bag), source, settings), settings, saved, page)


def live(
    address: Annotated[
        str, tyro.conf.Positional, tyro.conf.arg(metavar="ws://HOST:PORT", help="A Foxglove bridge.")
    ],
    *,
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
    page: PageArgs,
) -> None:
    """Show the stream of a running robot in the browser."""
    _show(_checked(address, source, settings), settings, saved, page)


def run(
    bag: Bag,
    *,
    out: Annotated[Path, tyro.conf.arg(help="Folder for the results.")],
    export: ExportArg = "default",
    note: NoteArg = (),
    settings: SettingArgs,
    saved: MapArgs,
    source: SourceArgs,
) -> int:
    """Process a recording as fast as it goes; leave trajectory, map, settings and figures.

    Exits with 3 when the pose is lost at the end, or in more than half of the scans.
    """
    from hectorscope.cli.report import show_progress, summary  # noqa: PLC0415
    from hectorscope.exporters import chosen as chosen_formats  # noqa: PLC0415
    from hectorscope.exporters import run as run_to_files  # noqa: PLC0415
    from hectorscope.run.notes import note as as_note  # noqa: PLC0415
    from hectorscope.web import shared_replay  # noqa: PLC0415

    formats = chosen_formats(export, [shared_replay.exporter([*map(as_note, note)], bag.name)])
    chosen = settings.settings()
    prior_map = saved.prior_map(chosen)
    recording = _checked(str(bag), source, settings)
    _get_ready()
    recording.check()
    for finding in recording.report.repaired:
        print(printable(f"repaired: {finding.fact} ({finding.repair})"))
    with show_progress(recording) as progress:
        figures = run_to_files(
            recording,
            chosen,
            out,
            truth=source.truth_topic,
            progress=progress,
            prior_map=prior_map,
            formats=formats,
            recording=bag,
        )
    summary(recording.name, figures, out)
    if not is_lost(figures):
        return 0
    print("hectorscope: the pose was lost, so the map cannot be trusted: see tracking above", file=sys.stderr)
    return LOST


def is_lost(figures: Mapping[str, Any]) -> bool:
    """Whether the pose of a run is lost at its end, or was so for too long."""
    lost = figures["tracking"].get("lost", 0)
    return bool(figures["tracking_at_end"] == "lost" or lost > LOST_SHARE * figures["scans"]["used"])


def inspect(bag: Bag, *, source: SourceArgs) -> None:
    """List what a recording contains and what each topic would be used for."""
    from hectorscope.checks.inspect import inspect_bag  # noqa: PLC0415

    print(inspect_bag(bag, source_options(source), repair=source.repair))


def _checked(uri: str, flags: Any, settings: SettingFlags) -> "CheckedSource":
    """The source behind a path or address, whose sensors are checked as it is read; SlamError for a bad one."""
    from hectorscope.checks.sensor_check import CheckedSource  # noqa: PLC0415

    settings.settings()  # a bad file is named before the source is opened
    options = source_options(flags, settings)
    return CheckedSource(partial(open_source, uri), options, repairs=flags.repair)


def _show(source: Source, settings: SettingFlags, saved: MapFlags, page: PageFlags) -> None:
    from hectorscope.exporters import reserved  # noqa: PLC0415
    from hectorscope.session.engine import Engine  # noqa: PLC0415
    from hectorscope.web.server import serve  # noqa: PLC0415

    chosen, token, budget = settings.settings(), page.secret(), page.budget()
    with reserved(page.out) if page.out is not None else nullcontext():
        prior = saved.prior_map(chosen)
        engine = Engine(source, chosen, prior, prepare=_get_ready, out=page.out, checkpoints=budget)
        try:
            serve(engine, engine.start, host=page.host, port=page.port, token=token)
        except KeyboardInterrupt:  # once more, while the page was being closed
            pass
        finally:
            with undisturbed():
                engine.stop()
                message = engine.save() if engine.started and page.out is not None else ""
    if message:
        print(printable(message))
    sys.exit(INTERRUPTED)  # nothing else ends the serving


def _get_ready(*report: Report) -> None:
    """Load or compile the kernels of the first scan; what is compiled is told to a `report`, if there is one."""
    from hectorscope.run.warmup import warm_up  # noqa: PLC0415

    warm_up(*report)
    gc.enable()


def demo_bag(scene: Scene) -> Path:
    """The recording of a scene, in a checkout or in an installed package; DemoError if it is in neither."""
    folder = resource_folder("demo_bags")
    for name in (f"{scene}.bag", f"{scene}.mcap", scene):
        if (folder / name).exists():
            return folder / name
    raise DemoError(f"the recording of {scene!r} is missing: make one by `hectorscope simulate --help`")


def _simulate_command(wanted: bool) -> Callable[..., None]:
    """The simulator's command; its options are only known after a slow import, done when it is `wanted`."""

    def described() -> None:
        """Make a recording of a simulated robot, with its truth."""

    if not wanted:
        return described
    from hectorscope.cli.report import show_simulation  # noqa: PLC0415
    from hectorscope.simulation import SimulateOptions  # noqa: PLC0415

    def simulate(options: Any) -> None:
        show_simulation(options)

    simulate.__doc__ = described.__doc__
    simulate.__annotations__["options"] = Annotated[SimulateOptions, tyro.conf.arg(name="")]
    return simulate


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit code: 2 for a mistake, with a line on stderr; 3: lost; 130: interrupted."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if list(arguments) == ["--version"]:
        print(f"hectorscope {version('hectorscope')}")
        return 0
    gc.disable()  # while the libraries come: it would go through all of them again and again
    commands: dict[str, Callable[..., Any]] = {
        "demo": demo,
        "view": view,
        "live": live,
        "run": run,
        "inspect": inspect,
        "simulate": _simulate_command(wanted="simulate" in arguments[:1]),
    }
    try:
        with ended_by_interruption(), delivered_later(), help_asked(arguments) as given:
            _refuse_empty(given)
            keep_compiled(*cache_places())
            code = tyro.extras.subcommand_cli_from_dict(
                commands,
                prog="hectorscope",
                description="Hector SLAM on a recording or a live robot, with every step shown in the browser."
                " --version alone prints the version.",
                args=given,
                config=(tyro.conf.DisallowNone,),
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
        if not argument or argument.endswith("="):
            name = argument or arguments[max(0, at - 1)]
            raise EmptyArgumentError(f"the value of {name.rstrip('=')} is empty: give one, or leave the flag out")


if __name__ == "__main__":
    sys.exit(main())
