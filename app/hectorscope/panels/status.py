"""The bar at the top: what is running, where it is, and whether anything was lost."""

from collections.abc import Mapping

from hectorscope.inputs import SourceReport
from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _workspace
from hectorscope.panels._format import clock, figure, fixed, text, tip
from hectorscope.panels._handles import put
from hectorscope.panels._message import message
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.transport import PAUSED
from slam_core.diagnostics import NO_ATTITUDE

REASONS_SHOWN = 12
EXPECTED = (NO_ATTITUDE, PAUSED)  # the initial alignment takes some scans, and a pause was somebody's wish
MODES = {"localise": "the saved map is left as it is", "continue": "the saved map goes on"}


class StatusPanel:
    """Two elements: the numbers that always change, and the losses, which stay put under the pointer."""

    title = "Status"
    order = 0
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        gui = scene.server.gui
        with _workspace.bar(scene, "status"):
            gui.add_html(BRAND)
            self._run = gui.add_html("")
            self._losses = gui.add_html("")
            gui.add_html(_own.tools())

    def draw(self, snapshot: Snapshot) -> None:
        """Assign what changed."""
        put(self._run, run_html(snapshot))
        put(self._losses, losses_html(snapshot.report, self._scene.failures, snapshot.warnings))


def run_html(snapshot: Snapshot) -> str:
    """The links, the source, the state, how a saved map is used or that its place is searched, and the rates."""
    playback, searching = snapshot.playback, text(snapshot.searching)
    chip = "" if snapshot.mode == "map" else _chip(snapshot.mode, "mode", MODES[snapshot.mode])
    if searching:
        chip = _chip("searching", "waiting", snapshot.searching)
    # What the scene tells in large type is not told here, where it would be cut off.
    detail = "" if message(snapshot) else text(playback.detail)
    stands = playback.state in ("empty", "paused", "ended", "failed", "waiting")
    figures = (
        figure("time", clock((playback.time_ns - playback.start_ns) / 1e9), "time"),
        figure("scans", "–" if stands else fixed(playback.scan_rate, 1) + " Hz"),
        figure("real time", "–" if stands else "×" + fixed(playback.realtime_factor, 2)),
    )
    return (
        f'<div class="hs-run">{SERVER}{robot_html(snapshot)}'
        f'<b class="hs-source" {tip("source", snapshot.source)}>{text(snapshot.source)}</b>'
        f"{_chip(playback.state, playback.state, playback.detail)}{chip}"
        + (f'<span class="hs-detail" title="{detail}">{detail}</span>' if detail else "")
        + "".join(figures)
        + "</div>"
    )


def _chip(word: str, kind: str, more: str) -> str:
    name = "mode" if kind == "mode" else "state"
    return f'<span class="hs-state hs-{kind}" {tip(name, more)}>{word}</span>'


def robot_html(snapshot: Snapshot) -> str:
    """The link to the robot, by a symbol and words; a recording has none."""
    report, playback = snapshot.report, snapshot.playback
    if not playback.live:
        return ""
    if report.connected is False:
        kind, words = "down", "✕ robot: no link"
    elif report.waiting or playback.state == "waiting":
        kind, words = "silent", "… robot: no scans"
    else:
        kind, words = "up", "✓ robot"
    return f'<span class="hs-link hs-link-{kind}" {tip("robot", report.waiting)}>{words}</span>'


def losses_html(report: SourceReport, failures: Mapping[str, str], warnings: tuple[str, ...] = ()) -> str:
    """What is wrong at this moment, dropped and skipped; the reasons unfold under the pointer."""
    skipped = sum(report.skipped.values())
    expected = sum(report.skipped.get(reason, 0) for reason in EXPECTED)
    lines = _reasons(report, failures, warnings)
    fold = f'<ul class="hs-tip">{"".join(f"<li>{line}</li>" for line in lines)}</ul>' if lines else ""
    shown = (
        figure("warnings", f"! {len(warnings)}", "bad") if warnings else "",
        figure("dropped", str(report.dropped), "bad" if report.dropped else ""),
        figure("skipped", str(skipped), "bad" if skipped > expected else ""),
        figure("failed", f"✕ {len(failures)}", "bad") if failures else "",
    )
    return f'<div class="hs-losses" tabindex="0">{"".join(shown)}{fold}</div>'


def _reasons(report: SourceReport, failures: Mapping[str, str], warnings: tuple[str, ...]) -> list[str]:
    """A line each: what is wrong, why scans were skipped, what was switched off."""
    reasons = [f"{count} × {text(reason)}" for reason, count in report.skipped.items()]
    hidden = len(reasons) - REASONS_SHOWN
    more = [f"and {hidden} more reasons"] if hidden > 0 else []
    broken = [f"{text(title)} is switched off: {text(why)}" for title, why in failures.items()]
    return [*map(text, warnings), *reasons[:REASONS_SHOWN], *more, *broken]


# Whether the page hears the server is known to the page alone: static/link.js.
SERVER = (
    f'<span class="hs-link hs-link-server" {tip("server")}>'
    '<span class="hs-hears">✓ server</span><span class="hs-deaf">✕ server: silent</span></span>'
)
BRAND = (
    '<div class="hs-brand"><svg viewBox="0 0 32 32" aria-hidden="true">'
    '<path d="M16 16 29 7.5M16 16 29.5 18M16 16 20 29.5M16 16 6 27.5M16 16 3 13M16 16 11.5 3.5" />'
    '<circle cx="16" cy="16" r="4.5"/></svg><span>Hectorscope</span></div>'
)

PANEL = StatusPanel
