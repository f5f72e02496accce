"""Serves the page, with the engine behind it, until the program is interrupted."""

import secrets
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from hectorscope.cli.interruption import undisturbed
from hectorscope.cli.opening import demos, get_ready, reserved_folder
from hectorscope.cli.options import MapFlags, SettingFlags
from hectorscope.cli.page_flags import PageFlags
from hectorscope.cli.publishing import published
from hectorscope.cli.station_flags import NO_STATION, StationOptions
from hectorscope.common.recent import Recent, recent_file
from hectorscope.common.terminal import printable
from hectorscope.inputs import Source
from hectorscope.run.report import Report
from hectorscope.session.exchange import Exchange
from hectorscope.session.kept_runs import KeptRuns
from hectorscope.session.library import Library, Opened, check_folders
from hectorscope.web.access_control import is_loopback
from hectorscope.web.server import PageServer, serve

if TYPE_CHECKING:
    from hectorscope.session.engine import Engine

AHEAD_AFTER_S = 4.0  # until then the first picture has the processor to itself


KEY_BYTES = 12  # of the teacher's link


def show(
    source: Source | None,
    settings: SettingFlags,
    saved: MapFlags,
    page: PageFlags,
    opened: Opened,
    shown: Path | None = None,
    station: StationOptions = NO_STATION,
) -> None:
    """Serve the page. opened: opens what it asks for. shown: where `source` lies, if it is a recording.
    station: what there is beside the run of a stream.

    The engine needs numba and the core, which take long to import: they come while a browser opens the page.
    """
    chosen, library, exchange = settings.settings(), _library(page, opened, shown), Exchange()
    budget, look_back = page.budget(), page.kept_seconds()  # bad ones are named before the page is served
    server = PageServer(
        exchange,
        host=page.host,
        port=page.port,
        token=page.secret(),
        upload_limit=page.uploads(),
        viewer_token=station.viewer_token,
        certificate=page.proof(),
        public=page.public_url,
        teacher=secrets.token_urlsafe(KEY_BYTES) if page.classroom else None,
    )
    with reserved_folder(page.out), published(station.publish, source) as observer:
        prior = saved.prior_map(chosen)

        def engine() -> "Engine":
            from hectorscope.session.engine import Engine  # noqa: PLC0415

            made = Engine(
                source,
                chosen,
                prior,
                exchange=exchange,
                out=page.out,
                checkpoints=budget,
                ahead_after=AHEAD_AFTER_S if page.ahead else None,
                look_back=look_back,
            )
            made.offer(library)
            made.observe(observer)
            if station.made is not None:
                made.attach(station.made())
            return made

        ready = partial(get_ready, live=source is not None and source.live)
        message = _serve(server, engine, ready)
    if message:
        print(printable(message))


def _serve(server: PageServer, made: Callable[[], "Engine"], ready: Callable[[Report], None]) -> str:
    """Serve until interrupted; what to say of the results that were saved then."""
    engines: list[Engine] = []

    def begin() -> None:
        engines.append(made())
        engines[0].start(ready)

    message = ""
    try:
        serve(server, begin)
    except KeyboardInterrupt:  # once more, while the page was being closed
        pass
    finally:
        with undisturbed():
            for engine in engines:
                engine.stop()
                message = engine.save() if engine.saves else ""
    return message


def _library(page: PageFlags, opened: Opened, shown: Path | None) -> Library:
    """What the page can open. The recent recordings of this person are for nobody else on the network."""
    check_folders(page.folder)
    recent = Recent(recent_file() if is_loopback(page.host) else None)
    library = Library(opened, page.folder, demos(), recent, KeptRuns(page.runs))
    if shown is not None:
        library.shown = shown
        library.note(shown)
    return library
