"""A sweep: what is missing in the table is done by an executor, and each run becomes a row as it ends."""

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, as_completed
from dataclasses import replace
from typing import Any

from hectorscope.sweep.executors import ClusterError
from hectorscope.sweep.guard import guarded
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.ranking import cost, target_of
from hectorscope.sweep.search import rungs, standing
from hectorscope.sweep.spec import RunSpec, RunSummary
from hectorscope.sweep.table import Table

Progress = Callable[[float], None]


def sweep(
    specs: Sequence[RunSpec],
    table: Table,
    executor: Executor,
    limits: Limits,
    progress: Progress = lambda _: None,
) -> None:
    """Do every run that has no row yet. progress: called with the share of the runs that is done.

    ClusterError if the executor ends before the runs do: all rows so far are kept.
    """
    missing = list({spec.key: spec for spec in specs if spec.key not in table}.values())
    done, futures = len(specs) - len(missing), dict[Future[str], RunSpec]()
    try:
        for spec in missing:
            futures[executor.submit(guarded, spec.as_json(), limits)] = spec
        for future in as_completed(list(futures)):
            table.append(futures.pop(future), _summary(future))
            done += 1
            progress(done / len(specs))
    except (BrokenExecutor, CancelledError, OSError, RuntimeError) as error:
        raise ClusterError(
            f"the workers were lost ({type(error).__name__}) with {len(futures)} runs to do: start the"
            " same command again to do the rest"
        ) from error
    finally:
        for future in futures:
            future.cancel()


def _summary(future: "Future[str]") -> RunSummary:
    try:
        return RunSummary.from_json(future.result())
    except (BrokenExecutor, CancelledError):
        raise
    except Exception as error:  # the executor gave up on this run: its workers died with it
        return RunSummary("crashed", f"its worker died ({type(error).__name__})")


def halving(
    bags: Collection[tuple[str, str]],
    settings: Sequence[RunSpec],
    table: Table,
    run: Callable[[Sequence[RunSpec]], None],
    target: str | None,
) -> list[RunSpec]:
    """Successive halving: all settings on the beginning of the recordings, the best of them on more; all specs.

    settings: one spec each. run: does specs. target: the figure that decides; None: as of `target_of`.
    """
    left, done = {spec.setting_key: spec for spec in settings}, list[RunSpec]()
    steps = rungs(len(left))
    for k, (share, _) in enumerate(steps):
        specs = [
            replace(spec, recording=name, path=path, share=share) for name, path in bags for spec in left.values()
        ]
        run(specs)
        done += specs
        if k + 1 < len(steps):
            best = standing(specs, costs(specs, table, target))[: steps[k + 1][1]]
            left = {key: spec for key, spec in left.items() if key in best}
    return done


def costs(specs: Sequence[RunSpec], table: Table, target: str | None) -> Mapping[str, float]:
    """Of each run by its key, by a figure, or by that of `target_of`; lower is better."""
    rows: dict[str, Any] = {spec.key: table.rows[spec.key] for spec in specs if spec.key in table}
    name = target or target_of(rows.values())
    return {key: cost(row, name) for key, row in rows.items()}
