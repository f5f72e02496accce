"""What is about to be seen, over the empty scene: the recording, how long it is, and what is being prepared."""

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import text
from hectorscope.panels._handles import put
from hectorscope.session.snapshot import Snapshot


class StartPanel:
    """A card until the first scan is drawn; then a line, while the run waits for something to be prepared."""

    title = "Start"
    order = 2
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        with _workspace.over_scene(scene, "start") as folder:
            self._card = scene.server.gui.add_html("")
        self._folder = folder
        folder.visible = False

    def draw(self, snapshot: Snapshot) -> None:
        """Assign what changed."""
        html = start_html(snapshot)
        put(self._card, html)
        if self._folder.visible != bool(html):
            self._folder.visible = bool(html)


def start_html(snapshot: Snapshot) -> str:
    """The card or the line; empty once there is nothing to wait for."""
    playback = snapshot.playback
    if playback.state == "empty":
        return NOTHING_OPEN
    if playback.state != "loading":
        return ""
    what = playback.preparing or playback.detail or READING
    waits = f'<p class="hs-preparing">{text(what)}</p>{progress_html(playback.prepared)}'
    if snapshot.scans:
        return f'<div class="hs-start hs-start-line">{waits}</div>'
    return (
        f'<div class="hs-start"><h2>{text(snapshot.source)}</h2><p>{contents(snapshot)}</p>'
        f"<p>{NEXT}</p>{waits}</div>"
    )


def contents(snapshot: Snapshot) -> str:
    """How many scans there are, and over how long a time."""
    playback, scans = snapshot.playback, snapshot.report.scans
    if playback.end_ns is None:
        return "A live stream."
    minutes, seconds = divmod(round((playback.end_ns - playback.start_ns) / 1e9), 60)
    long = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    return f"A recording of {long}." if scans is None else f"A recording of {scans} scans in {long}."


def progress_html(share: float | None) -> str:
    """A bar; without a share one that only shows that something is done."""
    value = "" if share is None else f' value="{min(1.0, max(0.0, share)):.3f}"'
    return f'<progress class="hs-progress"{value}></progress>'


NEXT = (
    "The robot and its map appear with the first scan; with inertial data, once that has shown which way is up,"
    " which takes about half a second of the recording."
)
NOTHING_OPEN = (
    '<div class="hs-start"><h2>No recording is open</h2><p>Choose one of this machine, or drop a file onto this'
    ' page.</p><button type="button" class="hs-wide" data-hs-do="recordings">Open a recording</button></div>'
)
READING = "Reading the first scans"

PANEL = StartPanel
