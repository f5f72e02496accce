"""Under the pointer, every figure of the page says what it is and when to worry."""

from dataclasses import replace

import numpy as np
import pytest

from hectorscope.inputs import SourceReport
from slam_core.results import PlanarGaussian
from tests.browser.conftest import Open, Show
from tests.page import room_snapshot

pytestmark = pytest.mark.browser

# Elements of ours with a digit in their own text, outside of what is prose, a name or a control.
BARE = r"""(() => {
  const prose = '.hs-log-list, .hs-find, .hs-differs, .hs-tip, .hs-fault, .hs-empty, .hs-message, '
    + '.hs-names, .hs-keys, .hs-xray-legend, .hs-own-box, button, select, style, svg';
  const own = (e) => [...e.childNodes].filter((n) => n.nodeType === 3).map((n) => n.textContent).join('');
  const ours = [...document.querySelectorAll('[class^="hs-"], [class^="hs-"] *')].filter((e) => !e.closest(prose));
  const figures = ours.filter((e) => e.matches('.hs-figure, .hs-state, .hs-link') || /\d/.test(own(e)));
  const bare = figures.filter((e) => !/orry/.test(e.closest('[title]')?.title ?? ''));
  return [figures.length, bare.map((e) => `${e.className}: ${e.textContent}`)];
})()"""


def test_every_figure_says_what_it_is_and_when_to_worry(show: Show, open_page: Open) -> None:
    """All tabs and both bars, of a run with a filter, losses, warnings, and a stream's links."""
    full = room_snapshot()
    assert full.result is not None
    world = PlanarGaussian(np.zeros(3), np.eye(3))
    report = SourceReport({"/scan": 9}, {"/scan: all NaN": 3}, 2, warnings=("late",), connected=True)
    page = open_page(show.url)
    for live in (False, True):
        show.engine.show(
            replace(
                full,
                sequence=full.sequence + 1 + live,
                result=full.result._replace(world=world),
                report=report,
                warnings=report.warnings,
                playback=replace(full.playback, live=live, end_ns=None if live else 10**9),
                unused={"gap in the inertial data": 3},
                mode="localise",
            )
        )
        page.wait_for_function(f"!!document.querySelector('.hs-link-up, .hs-link-silent') === {str(live).lower()}")
        seen, without = 0, []
        for tab in page.get_by_role("tab").all():
            tab.click()
            page.wait_for_function("e => e.getAttribute('aria-selected') === 'true'", arg=tab.element_handle())
            count, bare = page.evaluate(BARE)
            without += bare
            seen = max(seen, count)
        assert without == []
        assert seen > 30
