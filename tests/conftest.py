"""What every test may ask for: the real recordings, a Chromium, and kernels compiled from today's sources."""

import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from hectorscope.cli.interruption import ENDING
from hectorscope.common.kernel_cache import keep_compiled

ROOT = Path(__file__).resolve().parents[1]
CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")
NO_CHROMIUM = "no Chromium on the path: apt-get install chromium"


# Before numba is loaded; processes that tests start inherit it.
keep_compiled(ROOT / ".numba_cache")

FLAGS = [  # of a Chromium that draws in software
    "--no-sandbox",  # also runs as root, as in a container; it only opens our own page
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    # Software graphics would put the window together too, and draw a list of addresses that nobody sees.
    "--disable-gpu-compositing",
    "--disable-features=WebUIOmniboxPopup,WebUIOmniboxAimPopup,OptimizationHints,MediaRouter,PaintHolding",
]

# A first call compiles a kernel: how long an example takes says nothing.
settings.register_profile("compiled", deadline=None)
settings.load_profile("compiled")


def chromium_path() -> str | None:
    """The Chromium on the path, or None."""
    return next(filter(None, map(shutil.which, CHROMIUM_NAMES)), None)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last, being the slowest, and are skipped where there is no browser."""
    items.sort(key=_needs_browser)
    if chromium_path() is None:
        for item in filter(_needs_browser, items):
            item.add_marker(pytest.mark.skip(reason=NO_CHROMIUM))


def _needs_browser(item: pytest.Item) -> bool:
    return item.get_closest_marker("browser") is not None


@pytest.fixture(scope="session", autouse=True)
def heard_endings() -> Iterator[None]:
    """Programs that tests start hear Ctrl-C and its like, also where the tests run in a shell's background."""
    deaf = [number for number in ENDING if signal.getsignal(number) == signal.SIG_IGN]
    for number in deaf:
        signal.signal(number, signal.default_int_handler)
    yield
    for number in deaf:
        signal.signal(number, signal.SIG_IGN)


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of the Chromium that browser tests drive."""
    path = chromium_path()
    if path is None:
        pytest.skip(NO_CHROMIUM)
    return path


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of real recordings, which lies beside the project and is no part of it."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("no real recordings: ../shared/data is missing beside the project")
    return folder
