"""Serves the page, with the engine behind it, until the program is interrupted."""

from contextlib import nullcontext
from pathlib import Path

from hectorscope.cli.interruption import undisturbed
from hectorscope.cli.opening import demos, get_ready
from hectorscope.cli.options import MapFlags, PageFlags, SettingFlags
from hectorscope.common.recent import Recent, recent_file
from hectorscope.common.terminal import printable
from hectorscope.exporters import reserved
from hectorscope.inputs import Source
from hectorscope.session.engine import Engine
from hectorscope.session.kept_runs import KeptRuns
from hectorscope.session.library import Library, Opened, check_folders
from hectorscope.web.access_control import is_loopback
from hectorscope.web.server import PageServer, serve


def show(
    source: Source | None,
    settings: SettingFlags,
    saved: MapFlags,
    page: PageFlags,
    opened: Opened,
    shown: Path | None = None,
) -> None:
    """Serve the page. opened: opens what it asks for. shown: where `source` lies, if it is a recording."""
    chosen, budget, library = settings.settings(), page.budget(), _library(page, opened, shown)
    with reserved(page.out) if page.out is not None else nullcontext():
        prior = saved.prior_map(chosen)
        engine = Engine(
            source,
            chosen,
            prior,
            out=page.out,
            checkpoints=budget,
            runs_ahead=page.ahead,
            look_back=page.kept_seconds(),
            prepare=get_ready,
        )
        engine.offer(library)
        server = PageServer(
            engine, host=page.host, port=page.port, token=page.secret(), upload_limit=page.uploads()
        )
        try:
            serve(server, engine.start)
        except KeyboardInterrupt:  # once more, while the page was being closed
            pass
        finally:
            with undisturbed():
                engine.stop()
                message = engine.save() if engine.saves else ""
    if message:
        print(printable(message))


def _library(page: PageFlags, opened: Opened, shown: Path | None) -> Library:
    """What the page can open. The recent recordings of this person are for nobody else on the network."""
    check_folders(page.folder)
    recent = Recent(recent_file() if is_loopback(page.host) else None)
    library = Library(opened, page.folder, demos(), recent, KeptRuns(page.runs))
    if shown is not None:
        library.shown = shown
        library.note(shown)
    return library
