"""The list of runs as HTML, and the words by which a page asks for something."""

from dataclasses import replace

import numpy as np
import pytest

from hectorscope.panels.runs import command_of, runs_html
from hectorscope.run.settings import Settings
from hectorscope.session.commands import CompareRun, Fork, KeepRun, RemoveRun, RenameRun, RunCommand, ShowRun
from hectorscope.session.snapshot import Compared, ListedRun
from slam_core.config import SlamConfig, with_value
from tests.page import room_snapshot

OTHER = Settings(with_value(SlamConfig(), "fusion.omega", 0.5))
RUNS = (ListedRun(1, "<first>", "room", 0, OTHER), ListedRun(2, "second", "room", 0, Settings()))
SHOWN = replace(room_snapshot(), runs=RUNS, shown_run=2)


def compared(name: str) -> Compared:
    empty = np.empty((0, 8))
    return Compared(1, name, OTHER, False, empty, np.zeros(4), room_snapshot().series[:0], None)


@pytest.mark.parametrize(
    ("words", "command"),
    [
        ("fork:0:", Fork()),
        ("fork:0:with a: colon", Fork("with a: colon")),
        ("show:2:", ShowRun(2)),
        ("rename:2:" + "x" * 90, RenameRun(2, "x" * 60)),
        ("remove:2:", RemoveRun(2)),
        ("keep:0:", KeepRun()),
        ("compare:0:", CompareRun(0)),
    ],
)
def test_the_words_of_a_page_are_a_command(words: str, command: RunCommand) -> None:
    """Names are cut to their length."""
    assert command_of(words) == command


@pytest.mark.parametrize("words", ["", "show", "show:2", "show:-1:", "show:9999999:", "drop:1:", " show:1:"])
def test_other_words_are_none(words: str) -> None:
    """Whatever a page sends."""
    assert command_of(words) is None


def test_names_are_escaped_and_the_shown_run_cannot_be_removed() -> None:
    """The others can be shown, compared, renamed and removed."""
    html = runs_html(SHOWN)
    assert "&lt;first&gt;" in html and "<first>" not in html
    assert {verb for verb in ("show", "compare", "rename", "remove") if f"{verb}:1:" in html} == {
        "show", "compare", "rename", "remove",
    }  # fmt: skip
    assert "remove:2:" not in html and "rename:2:" in html
    assert "keep:0:" not in html and "keep:0:" in runs_html(replace(SHOWN, keeps=True))


def test_the_settings_that_differ_are_listed_with_both_values() -> None:
    """Of the compared run; while that is on its way, it is said."""
    html = runs_html(replace(SHOWN, compared=compared("<first>")))
    assert "fusion.omega" in html and "<td>0.5</td>" in html
    assert html.count("<tr>") == 2
    assert "on its way" in html
    assert "<first>" not in html


def test_a_run_of_another_recording_is_not_compared() -> None:
    """It has no place in the same map."""
    other = (replace(RUNS[0], source="kitchen"), RUNS[1])
    assert "compare:1:" not in runs_html(replace(SHOWN, runs=other))


def test_a_stream_and_an_empty_page_have_no_list() -> None:
    """They say why."""
    live = replace(SHOWN, playback=replace(SHOWN.playback, live=True))
    assert "cannot be run again" in runs_html(live)
    assert "No run yet" in runs_html(replace(SHOWN, scans=0))
