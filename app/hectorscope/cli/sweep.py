"""hectorscope sweep: from the flags to specs, an executor and a table; and the page that shows one."""

from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from hectorscope.cli.options import SettingFlags, source_options
from hectorscope.cli.page_flags import AddressFlags
from hectorscope.cli.report import show_sweep, sweep_summary
from hectorscope.cli.sweep_flags import SweepFlags
from hectorscope.common.paths import is_file
from hectorscope.exporters import OutputError, reserved
from hectorscope.run.relations import read_relations
from hectorscope.sweep.executors import executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.plan import from_file, product, recordings, with_setting
from hectorscope.sweep.ranking import check_target
from hectorscope.sweep.search import quasi_random
from hectorscope.sweep.spec import RunSpec, differing
from hectorscope.sweep.sweep import halving, sweep
from hectorscope.sweep.table import BROKEN, Table, write_parquet
from hectorscope.sweep.vary import VaryError, check_axes, combinations, parse

Bags = list[tuple[str, str]]


def do(bags: Sequence[str], out: Path | None, flags: SweepFlags, settings: SettingFlags, source: Any) -> None:
    """Run what the flags ask for; SlamError for flags that are of no use, before anything is run."""
    if out is None:
        raise OutputError("--out is missing: give a folder for the table, or --show DIR to look at one")
    base, found = _base(flags, settings, source), recordings(bags)
    limits = Limits(flags.time_limit, flags.memory_limit)
    limits.check()
    check_target(flags.target)
    specs, names = _planned(flags, found, base)
    with reserved(out, ()), executor(flags.workers, flags.cluster or "") as pool:
        table = Table(out, names)
        if flags.retry:
            table.forget(BROKEN)
        run = partial(_shown, table=table, pool=pool, limits=limits)
        if flags.halving:
            specs = halving(found, specs, table, run, flags.target)
        else:
            run(specs)
        table.finish(specs)
        if flags.parquet:
            write_parquet(out)
    sweep_summary(table, specs, flags.target, out)


def _base(flags: SweepFlags, settings: SettingFlags, source: Any) -> RunSpec:
    """What all runs share; SlamError for a bad file or value."""
    chosen, options = settings.settings(), asdict(source_options(source, settings))
    stated = {name: value for name, value in options.items() if value is not None}
    truth = str(stated.get("truth_topic", ""))
    if truth and is_file(Path(truth)):  # a corrected log: workers have other folders
        stated["truth_topic"] = str(Path(truth).resolve())
    if flags.relations:
        read_relations(flags.relations)
    return RunSpec(
        "",
        "",
        differing(chosen.start),
        tuple((change.time_ns, change.name, change.value) for change in chosen.changes),
        stated,
        repair=source.repair,
        relations=str(flags.relations.resolve()) if flags.relations else "",
    )


def _planned(flags: SweepFlags, bags: Bags, base: RunSpec) -> tuple[list[RunSpec], list[str]]:
    """The specs, one a setting for a search by halving, and the names that are varied."""
    _check(flags, bags)
    if flags.runs:
        return from_file(flags.runs, bags, base)
    axes = [parse(text) for text in flags.vary]
    check_axes(axes)
    names = [axis.name for axis in axes]
    if flags.search:
        settings = [{}, *quasi_random(axes, flags.search - 1, flags.seed)]  # the first is what all others share
    else:
        settings = list(combinations(axes))
    if flags.halving:
        return list(
            {s.setting_key: s for s in (with_setting(base, values) for values in settings)}.values()
        ), names
    return product(bags, settings, base), names


def _check(flags: SweepFlags, bags: Bags) -> None:
    """VaryError for flags that contradict each other."""
    if flags.runs and (flags.vary or flags.search):
        raise VaryError("--runs lists the runs itself: leave --vary and --search out")
    if flags.search < 0:
        raise VaryError(f"--search {flags.search} is less than nothing: give a number of settings")
    if flags.seed < 0:
        raise VaryError(f"--seed {flags.seed} is less than nothing: give a whole number from 0 on")
    if flags.halving and not flags.search:
        raise VaryError("--halving is a way to search: give --search N too")
    if not bags and not flags.runs:
        raise VaryError("there is no recording: name one or more, or a list by --runs FILE")


def _shown(specs: Sequence[RunSpec], *, table: Table, pool: Any, limits: Limits) -> None:
    """A part of the sweep under a bar."""
    with show_sweep(len(specs)) as progress:
        sweep(specs, table, pool, limits, progress)


def show(folder: Path, address: AddressFlags) -> None:
    """Serve the page of a sweep until interrupted."""
    from hectorscope.web.sweep_server import serve_sweep  # noqa: PLC0415

    serve_sweep(folder, host=address.host, port=address.port, token=address.secret())
