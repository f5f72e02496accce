"""What the sensor check found, over the scene, with a button that repairs it; what was repaired, in the log."""

from collections.abc import Sequence

from viser import GuiButtonHandle, GuiEvent, Icon

from hectorscope.inputs import Finding
from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import clock, text
from hectorscope.panels._handles import put, show
from hectorscope.session.commands import Examine, Repair
from hectorscope.session.snapshot import PlaybackStatus, Snapshot


class FindingsPanel:
    """A card where the run was refused; a line where it goes on, which can be left at that."""

    title = "Findings"
    order = 71  # after the log, whose tab it shares
    rate = 4.0

    def __init__(self, scene: Scene) -> None:
        gui = scene.server.gui
        self._send = scene.send
        self._left: tuple[Finding, ...] = ()  # what somebody wants to leave as it is
        self._shown: tuple[Finding, ...] = ()
        with _workspace.tab(scene, "Log", Icon.LIST_DETAILS):
            self._repaired = gui.add_html("", order=-1.0)
            self._examine = gui.add_button(
                "Examine the recording", icon=Icon.STETHOSCOPE, order=-0.9,
                hint="Reads all of it beside the run: gaps, jitter, clocks, frames, beams.",
            )  # fmt: skip
            self._examined = gui.add_html("", order=-0.8)
        self._folder = _workspace.over_scene(scene, "findings")
        with self._folder:
            self._text = gui.add_html("")
            self._repair = gui.add_button("Repair and begin again", icon=Icon.TOOL)
            self._leave = gui.add_button("Leave it as it is", color="gray")
        self._repair.on_click(self._begin_again)
        self._leave.on_click(self._leave_it)
        self._examine.on_click(lambda _: scene.send(Examine()))
        self._folder.visible = False

    def draw(self, snapshot: Snapshot) -> None:
        """Assign what changed."""
        report, refused = snapshot.report, snapshot.playback.state == "failed"
        found = report.findings if refused or report.findings != self._left else ()
        self._shown = found
        put(self._repaired, repaired_html(report.repaired))
        put(self._examined, examined_html(snapshot.examined, snapshot.playback))
        show(self._examine, not snapshot.playback.live)
        put(self._text, findings_html(found, refused=refused))
        for handle, visible in ((self._folder, bool(found)), (self._leave, not refused)):
            if handle.visible != visible:
                handle.visible = visible

    def _begin_again(self, _: GuiEvent[GuiButtonHandle]) -> None:
        self._send(Repair())

    def _leave_it(self, _: GuiEvent[GuiButtonHandle]) -> None:
        self._left = self._shown


def findings_html(found: Sequence[Finding], *, refused: bool) -> str:
    """Each fact with the options that repair it."""
    if not found:
        return ""
    title, follows = (REFUSED, WAYS) if refused else (WARNED, "")
    facts = "".join(f"<li>{_sentence(finding.fact)}<code>{text(finding.repair)}</code></li>" for finding in found)
    kind = "" if refused else " hs-findings-line"
    return f'<div class="hs-findings{kind}"><h2>{title}</h2><ul>{facts}</ul>{follows}</div>'


def examined_html(found: Sequence[Finding] | None, playback: PlaybackStatus) -> str:
    """What is wrong with the recording, each with its remedy and a time that leads there (static/log.js)."""
    if found is None:
        return ""
    if not found:
        return '<p class="hs-empty">Topics, clocks, frames and beams are in order.</p>'
    rows = "".join(f"<li>{_when(each, playback)}{_sentence(each.fact)}{_remedy(each)}</li>" for each in found)
    return f'<div class="hs-findings hs-repaired hs-examined"><b>Wrong with the recording</b><ul>{rows}</ul></div>'


def _when(finding: Finding, playback: PlaybackStatus) -> str:
    if finding.time_ns is None:
        return ""
    seconds = (finding.time_ns - playback.start_ns) / 1e9
    return (
        f'<button type="button" class="hs-when" title="Go there" data-hs-seconds="{max(0.0, seconds):.3f}">'
        f"{clock(seconds)}</button> "
    )


def _remedy(finding: Finding) -> str:
    repair = f"<code>{text(finding.repair)}</code>" if finding.options else ""
    return f" <small>{_sentence(finding.remedy)}</small>{repair}" if finding.remedy else repair


def repaired_html(repaired: Sequence[Finding]) -> str:
    """The same of what was repaired; empty for nothing."""
    facts = "".join(f"<li>{_sentence(each.fact)}<code>{text(each.repair)}</code></li>" for each in repaired)
    return f'<div class="hs-findings hs-repaired"><b>Repaired</b><ul>{facts}</ul></div>' if facts else ""


def _sentence(fact: str) -> str:
    return text(fact[:1].upper() + fact[1:] + ".")


REFUSED = "The sensors contradict each other"
WARNED = "Found by the sensor check"
WAYS = (
    "<p>A map of this would be wrong, so the run has not begun. <em>Repair and begin again</em> opens the input"
    " with these options, as --repair does from the start; config.toml keeps them.</p>"
)

PANEL = FindingsPanel
