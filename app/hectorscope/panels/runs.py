"""The runs of the session: their list, what is done with each, and what the compared one differs in."""

import re
from collections.abc import Callable
from typing import Any

from viser import GuiEvent, Icon

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _workspace
from hectorscope.panels._controls import by_hand
from hectorscope.panels._format import clock, text, title, worded
from hectorscope.panels._handles import put, put_value
from hectorscope.run.permalink import LONGEST_NAME
from hectorscope.session.commands import (
    ComparePaper,
    CompareRun,
    Fork,
    KeepRun,
    RemoveRun,
    RenameRun,
    RunCommand,
    ShowRun,
)
from hectorscope.session.snapshot import ListedRun, Snapshot
from slam_core.config import Leaves, differences

BESIDE = (
    '<label class="hs-own-box" title="In this browser; else its walls and its way lie over those shown.">'
    '<input type="checkbox" data-hs-own="beside">Beside the shown run, not over it</label>'
)
ASKED = re.compile(r"(fork|show|rename|remove|keep|compare|paper):([0-9]{1,6}):(.*)", re.DOTALL)
COMMANDS: dict[str, Callable[[int, str], RunCommand]] = {
    "fork": lambda _, name: Fork(name),
    "show": lambda number, _: ShowRun(number),
    "rename": RenameRun,
    "remove": lambda number, _: RemoveRun(number),
    "keep": lambda _, __: KeepRun(),
    "compare": lambda number, _: CompareRun(number),
    "paper": lambda _, __: ComparePaper(),
}


class RunsPanel:
    """HTML whose buttons static/runs.js turns into words for a hidden control."""

    title = "Runs"
    order = 63
    rate = 4.0

    def __init__(self, scene: Scene) -> None:
        self._send = scene.send
        gui = scene.server.gui
        with _workspace.tab(scene, self.title, Icon.GIT_BRANCH):
            asked = gui.add_text("Runs", "", visible=False)
            gui.add_html(f'{_own.SHARED}<i class="hs-mark" data-hs-runs="{viser_private.uuid_of(asked)}"></i>')
            self._list = gui.add_html(runs_html(Snapshot()))
        asked.on_update(by_hand(self._ask))

    def draw(self, snapshot: Snapshot) -> None:
        """Assign what changed."""
        put(self._list, runs_html(snapshot))

    def _ask(self, event: GuiEvent[Any]) -> None:
        wanted = command_of(event.target.value)
        put_value(event.target, "")  # so that the same can be asked for again
        if wanted is not None:
            self._send(wanted)


def command_of(words: str) -> RunCommand | None:
    """What a page asks for; None for what it could not have asked."""
    found = ASKED.fullmatch(words)
    return COMMANDS[found[1]](int(found[2]), found[3][:LONGEST_NAME]) if found else None


def runs_html(snapshot: Snapshot) -> str:
    """The list with its buttons, and the table of the settings that differ; a stream has no runs."""
    if snapshot.playback.live:
        return '<p class="hs-empty">A stream cannot be run again, so it has no runs to choose from.</p>'
    if not snapshot.scans:
        return '<p class="hs-empty">No run yet.</p>'
    head = _button("fork", 0, "Fork here", "Keep this run in the list, and go on with another one from here")
    hint = "The same recording by the paper's method, without what was added since, beside this run"
    head += _button("paper", 0, "Compare with the paper", hint)
    if snapshot.keeps:
        head += _button("keep", 0, "Keep on disk", "Write a RUN.toml, from which it can be opened again")
    rows = "".join(_row(run, snapshot) for run in snapshot.runs)
    return f'<div class="hs-runs"><p>{head}</p><ol>{rows}</ol>{differing_html(snapshot)}</div>'


def _row(run: ListedRun, snapshot: Snapshot) -> str:
    shown = run.number == snapshot.shown_run
    compared = snapshot.compared is not None and run.number == snapshot.compared.number
    where = "shown" if shown else f"{text(run.source)} at {clock(run.offset_ns / 1e9)}"
    buttons = _button("rename", run.number, "Rename", "Give it another name", run.name)
    if not shown:
        show = _button("show", run.number, "Show", "Show this run where it was; the shown one stays in the list")
        words = ("compare", 0, "Stop comparing") if compared else ("compare", run.number, "Compare")
        compare = _button(*words, "Its trajectory and map over those of the shown run, at the same time")
        same = run.source == snapshot.source
        buttons = (
            show
            + (compare if same else "")
            + buttons
            + _button("remove", run.number, "Remove", "Undo for a minute")
        )
    kind = " hs-run-shown" if shown else " hs-run-compared" if compared else ""
    return f'<li class="hs-run-row{kind}"><b>{text(run.name)}</b><small>{where}</small><span>{buttons}</span></li>'


def _button(verb: str, number: int, words: str, hint: str, name: str = "") -> str:
    asks = f'data-hs-run="{verb}:{number}:" data-hs-name="{text(name)}"'
    return f'<button type="button" {asks} title="{text(hint)}">{words}</button>'


def differing_html(snapshot: Snapshot) -> str:
    """The settings in which the shown and the compared run differ at this time, with both values."""
    compared = snapshot.compared
    if compared is None:
        return ""
    other = compared.settings.at(snapshot.playback.time_ns)
    known, values = Leaves(snapshot.config), differences(snapshot.config, other)
    rows = "".join(
        f"<tr><th>{text(title(known[name]))}<small>{text(name)}</small></th>"
        f"<td>{text(worded(known[name].value))}</td><td>{text(worded(value))}</td></tr>"
        for name, value in values.items()
    )
    if not rows:
        rows = '<tr><td colspan="3">No setting differs at this time.</td></tr>'
    waits = "" if compared.whole else '<p class="hs-preparing">The compared run is on its way to this time.</p>'
    return (
        '<table class="hs-compared"><thead><tr><th>Setting</th><th>shown</th>'
        f'<th><i class="hs-dot" style="background:var(--hs-compared)"></i>{text(compared.name)}</th></tr></thead>'
        f"<tbody>{rows}</tbody></table>{waits}{BESIDE}"
    )


PANEL = RunsPanel
