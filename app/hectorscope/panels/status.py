"""The bar at the top: what is running, where it is, and whether anything was lost."""

from collections.abc import Mapping

from hectorscope.inputs import SourceReport
from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _workspace
from hectorscope.panels._format import clock, figure, fixed, text
from hectorscope.panels._handles import put
from hectorscope.run.settings import Mode
from hectorscope.session.snapshot import PlaybackStatus, Snapshot
from slam_core.navigation.monitor import NO_ATTITUDE

REASONS_SHOWN = 12
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
        put(self._run, run_html(snapshot.source, snapshot.playback, snapshot.mode, snapshot.searching))
        put(self._losses, losses_html(snapshot.report, self._scene.failures, snapshot.warnings))


def run_html(source: str, playback: PlaybackStatus, mode: Mode = "map", searching: str = "") -> str:
    """The source, the state with its reason, how a saved map is used or why no place in it is known, and rates."""
    detail = text(playback.detail or searching)
    chip = "" if mode == "map" else f'<span class="hs-state" title="{MODES[mode]}">{mode}</span>'
    if searching:
        chip = f'<span class="hs-state hs-waiting" title="{text(searching)}">searching</span>'
    figures = (
        figure("time", clock((playback.time_ns - playback.start_ns) / 1e9), "time"),
        figure("scans", fixed(playback.scan_rate, 1) + " Hz"),
        figure("real time", "×" + fixed(playback.realtime_factor, 2)),
    )
    return (
        f'<div class="hs-run"><b class="hs-source" title="{text(source)}">{text(source)}</b>'
        f'<span class="hs-state hs-{playback.state}" title="{detail}">{playback.state}</span>{chip}'
        + (f'<span class="hs-detail" title="{detail}">{detail}</span>' if detail else "")
        + "".join(figures)
        + "</div>"
    )


def losses_html(report: SourceReport, failures: Mapping[str, str], warnings: tuple[str, ...] = ()) -> str:
    """What is wrong at this moment, dropped and skipped; the reasons unfold under the pointer."""
    skipped = sum(report.skipped.values())
    reasons = [f"{count} × {text(reason)}" for reason, count in report.skipped.items()]
    hidden = len(reasons) - REASONS_SHOWN
    broken = [f"{text(title)} is switched off: {text(why)}" for title, why in failures.items()]
    lines = [text(warning) for warning in warnings]
    lines += reasons[:REASONS_SHOWN] + ([f"and {hidden} more reasons"] if hidden > 0 else []) + broken
    fold = f'<ul class="hs-tip">{"".join(f"<li>{line}</li>" for line in lines)}</ul>' if lines else ""
    dropped = figure("dropped", str(report.dropped), "bad" if report.dropped else "")
    expected = report.skipped.get(NO_ATTITUDE, 0)  # the initial alignment takes some scans
    shown = figure("skipped", str(skipped), "bad" if skipped > expected else "")
    failed = figure("failed", str(len(broken)), "bad") if broken else ""
    wrong = figure("warnings", str(len(warnings)), "bad") if warnings else ""
    return f'<div class="hs-losses" tabindex="0">{wrong}{dropped}{shown}{failed}{fold}</div>'


BRAND = (
    '<div class="hs-brand"><svg viewBox="0 0 32 32" aria-hidden="true">'
    '<path d="M16 16 29 7.5M16 16 29.5 18M16 16 20 29.5M16 16 6 27.5M16 16 3 13M16 16 11.5 3.5" />'
    '<circle cx="16" cy="16" r="4.5"/></svg><span>Hectorscope</span></div>'
)

PANEL = StatusPanel
