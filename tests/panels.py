"""A real run and the controls of its page, as a person finds them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from playwright.sync_api import Locator, Page

from hectorscope.run.settings import Settings
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from slam_core.config import SlamConfig, with_values
from tests.engines import until

START = Settings(with_values(SlamConfig(), {"map.size": 512, "fusion.omega": 0.1}))
PATIENCE_S = 120.0


@dataclass
class Run:
    """An engine and its page."""

    engine: Engine
    url: str

    @property
    def now(self) -> Snapshot:
        """The newest snapshot."""
        snapshot = self.engine.mailbox.latest
        assert snapshot is not None
        return snapshot

    def until(self, holds: Callable[[Snapshot], Any]) -> Snapshot:
        """The first snapshot that `holds`; fails after a while."""
        return until(self.engine, holds, PATIENCE_S)


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name)


def row(page: Page, label: str) -> Locator:
    """A control by its label."""
    return page.locator(".mantine-Flex-root", has=page.locator(f"label:text-is('{label}')"))


def open_tab(page: Page, title: str) -> None:
    page.get_by_role("tab", name=title).click()


def choose(page: Page, container: str, option: str) -> None:
    """An entry of the first list in a container that the style sheet knows."""
    page.locator(f"div:has(> div > .hs-{container}) .mantine-Select-input").first.click()
    page.locator("[role=option]:visible", has_text=option).click()
