"""The flags of `hectorscope sweep` alone."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hectorscope.cli.options import optional


@dataclass
class SweepFlags:
    """What is run, where, and within which limits."""

    vary: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        tyro.conf.arg(
            metavar="NAME=VALUES",
            help="Setting or sensors.OPTION with its values: A,B,C, LOW:HIGH:COUNT or LOW:HIGH:logCOUNT.",
            help_behavior_hint="",
        ),
    ] = ()
    runs: Annotated[Path | None, optional("TOML file with a list of runs, in the place of --vary.")] = None
    search: Annotated[
        int,
        tyro.conf.arg(help="Try so many settings, spread evenly over the ranges of --vary; 0: every combination."),
    ] = 0
    halving: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        tyro.conf.arg(help="Search on the beginning of the recordings first, and keep the best third for more."),
    ] = False
    target: Annotated[
        str | None, optional("Figure to search for.", "truth.aligned_rmse_m, without a truth consistency")
    ] = None
    seed: Annotated[int, tyro.conf.arg(help="Of the search: the same seed gives the same settings.")] = 1
    workers: Annotated[int, tyro.conf.arg(help="Processes of this machine; 0: one a processor.")] = 0
    cluster: Annotated[
        str | None,
        tyro.conf.arg(
            metavar="tcp://HOST:PORT",
            help="Dask scheduler whose workers do the runs.",
            help_behavior_hint="(default: this machine)",
        ),
    ] = None
    time_limit: Annotated[float, tyro.conf.arg(help="Seconds that a run may take; 0: no limit.")] = 3600.0
    memory_limit: Annotated[
        float, tyro.conf.arg(help="MiB of memory that the process of a run may take; 0: no limit.")
    ] = 0.0
    relations: Annotated[
        Path | None, optional("File of relations (time1 time2 x y z roll pitch yaw) that score every run.")
    ] = None
    retry: Annotated[
        tyro.conf.FlagCreatePairsOff[bool], tyro.conf.arg(help="Do runs again that failed or broke a limit.")
    ] = False
    parquet: Annotated[
        tyro.conf.FlagCreatePairsOff[bool], tyro.conf.arg(help="Write the table as runs.parquet too, at the end.")
    ] = False


SweepArgs = Annotated[SweepFlags, tyro.conf.arg(name="")]
