"""The bar at the bottom: play, pause, step, restart, undo, speed, the timeline, and the same as hotkeys.

A stream has no steps, no speed and no other times: it shows none of them.
"""

import math
from collections.abc import Callable
from time import monotonic
from typing import Any, cast

from viser import GuiEvent, GuiSliderHandle, Icon, IconName

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import clock, tip
from hectorscope.panels._handles import put, put_value, show
from hectorscope.session.commands import (
    ChangeSpeed,
    PlayPause,
    Restart,
    Save,
    Seek,
    SetSpeed,
    StepBack,
    StepScan,
    Undo,
)
from hectorscope.session.playback import ON_OFFER, nearest_speed
from hectorscope.session.snapshot import PlaybackStatus, Snapshot, UndoOffer

SPEEDS = {f"{speed:g}×" if math.isfinite(speed) else "max": speed for speed in ON_OFFER}
SETTLE = 0.25  # seconds that the timeline must rest before a jump: dragging is not a hundred jumps
HOLD = 2.0  # seconds that the timeline waits for the run to arrive before it shows the run's own time again
RUNNING = ("playing", "seeking", "waiting")
LONGEST = 28  # characters of what an undo takes back
STEP = 0.1  # seconds a nudge of the timeline


class TransportPanel:
    """Callbacks send commands or note a wish; `draw` follows what the run really does."""

    title = "Transport"
    order = 10
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._playback = PlaybackStatus()
        self._speed_drawn = ""
        gui = scene.server.gui
        with _workspace.bar(scene, "transport"):
            self._restart = gui.add_button("Restart · R", icon=Icon.PLAYER_SKIP_BACK_FILLED)
            self._toggle = gui.add_button("Play · space", icon=Icon.PLAYER_PLAY_FILLED)
            self._step = gui.add_button("Step one scan · .", icon=Icon.PLAYER_TRACK_NEXT_FILLED)
            self._save = gui.add_button("Save the results", icon=Icon.DEVICE_FLOPPY, visible=False)
            gui.add_html('<i class="hs-mark hs-undo"></i>')
            self._undo = gui.add_button("Undo · U", icon=Icon.ARROW_BACK_UP, visible=False)
            self._clock = gui.add_html("")
            self._slider = timeline = gui.add_slider("Timeline", 0.0, 1.0, STEP, initial_value=0.0)
            # for static/log.js
            gui.add_html(f'<i class="hs-mark" data-hs-timeline="{viser_private.uuid_of(timeline)}"></i>')
            self._speed = gui.add_dropdown(
                "Speed", tuple(SPEEDS), initial_value="1×", hint="Times real time. Keys [ and ]."
            )
        self._timeline = Timeline(timeline)
        self._restart.on_click(lambda _: scene.send(Restart()))
        self._toggle.on_click(lambda _: scene.send(PlayPause()))
        self._step.on_click(lambda _: scene.send(StepScan()))
        self._save.on_click(lambda _: scene.send(Save()))
        self._undo.on_click(lambda _: scene.send(Undo()))
        self._speed.on_update(self._choose_speed)
        self._add_hotkeys()

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the run."""
        self._playback = playback = snapshot.playback
        running = playback.state in RUNNING
        label = "Pause · space" if running else "Play · space"
        if self._toggle.label != label:
            self._toggle.label = label
            self._toggle.icon = Icon.PLAYER_PAUSE_FILLED if running else Icon.PLAYER_PLAY_FILLED
        show(self._save, snapshot.saves)
        for control in (self._step, self._slider, self._speed):
            show(control, not playback.live)
        self._draw_undo(snapshot.undo, monotonic())
        self._draw_speed(name_of_speed(playback.speed))
        self._timeline.draw(playback, self._scene.send, monotonic())
        put(self._clock, clock_html(playback))

    def _draw_undo(self, offer: UndoOffer | None, now: float) -> None:
        """What can be taken back, and for how many seconds."""
        show(self._undo, offer is not None)
        if offer is not None:
            words = undo_words(offer, now)
            if self._undo.label != words:
                self._undo.label = words

    def _draw_speed(self, name: str) -> None:
        """Follow the run's speed, but leave alone what a hand has just chosen and the run does not know yet."""
        if name != self._speed_drawn:
            self._speed_drawn = name
            put_value(self._speed, name)

    def _choose_speed(self, event: GuiEvent[Any]) -> None:
        if event.client is not None and event.target.value in SPEEDS:
            self._scene.send(SetSpeed(SPEEDS[event.target.value]))

    def _add_hotkeys(self) -> None:
        send = self._scene.send
        self._hotkey("Play or pause", "space", Icon.PLAYER_PLAY, lambda: send(PlayPause()))
        self._hotkey("Step one scan", ".", Icon.PLAYER_TRACK_NEXT, lambda: send(StepScan()))
        self._hotkey("Back one scan", ",", Icon.PLAYER_TRACK_PREV, lambda: send(StepBack()))
        self._hotkey("Restart", "R", Icon.PLAYER_SKIP_BACK, lambda: send(Restart()))
        self._hotkey("Undo", "U", Icon.ARROW_BACK_UP, lambda: send(Undo()))
        self._hotkey("Slower", "[", Icon.MINUS, lambda: send(ChangeSpeed(-1)))
        self._hotkey("Faster", "]", Icon.PLUS, lambda: send(ChangeSpeed(+1)))

    def _hotkey(self, title: str, key: str, icon: IconName, act: Callable[[], None]) -> None:
        # The page takes any key that a keyboard event names; the declared type lists letters and a few more.
        command = self._scene.server.gui.add_command(title, hotkey=cast(Any, key), icon=icon)
        command.on_trigger(lambda _: act())


class Timeline:
    """A slider that shows the run's time, except while a hand is on it or a jump is under way."""

    def __init__(self, slider: GuiSliderHandle[float]) -> None:
        self._slider = slider
        self._shown = slider.value  # what was put there; another value comes from a hand
        self._touched: float | None = None
        self._arriving: tuple[int, float] | None = None
        slider.on_update(self._note)

    def _note(self, event: GuiEvent[Any]) -> None:
        if event.client is not None and self._slider.value != self._shown:
            self._touched = monotonic()

    def draw(self, playback: PlaybackStatus, send: Callable[[Seek], None], now: float) -> None:
        """Send the jump once the slider rests; else show the time."""
        self._fit(playback)
        if self._touched is None and self._slider.value != self._shown:
            self._touched = now  # the value is there before its event: it must not be overwritten
        if self._touched is not None:
            if now - self._touched >= SETTLE and not self._slider.disabled:
                self._touched = None
                self._shown = self._slider.value
                target = playback.start_ns + round(min(max(self._slider.value, 0.0), self._slider.max) * 1e9)
                self._arriving = target, now
                send(Seek(target))
        elif not self._on_the_way(playback, now):
            seconds = (playback.time_ns - playback.start_ns) / 1e9
            self._shown = round(min(max(seconds, 0.0), self._slider.max), 2)
            put_value(self._slider, self._shown)

    def _on_the_way(self, playback: PlaybackStatus, now: float) -> bool:
        if self._arriving is None:
            return False
        target, since = self._arriving
        there = playback.state != "seeking" and abs(playback.time_ns - target) < 1e9
        if there or (playback.state != "seeking" and now - since > HOLD):
            self._arriving = None
        return self._arriving is not None

    def _fit(self, playback: PlaybackStatus) -> None:
        """Take the recording's length; a stream has none."""
        end = playback.end_ns
        length = STEP if end is None else max(STEP, (end - playback.start_ns) / 1e9)
        if self._slider.max != length:
            self._slider.max = length
        if self._slider.disabled != (end is None):
            self._slider.disabled = end is None


def name_of_speed(speed: float) -> str:
    """The nearest speed on offer."""
    return next(name for name, value in SPEEDS.items() if value == nearest_speed(speed))


def undo_words(offer: UndoOffer, now: float) -> str:
    """What is taken back, shortened, and the seconds left; now: `time.monotonic`."""
    what = offer.what if len(offer.what) <= LONGEST else offer.what[: LONGEST - 1] + "…"
    return f"Undo {what} · {max(0, math.ceil(offer.expires - now))} s"


def clock_html(playback: PlaybackStatus) -> str:
    """Time now, and of how much."""
    now = clock((playback.time_ns - playback.start_ns) / 1e9)
    end_ns = playback.end_ns
    whole = (
        ("live" if playback.live else "") if end_ns is None else "/ " + clock((end_ns - playback.start_ns) / 1e9)
    )
    return f'<div class="hs-clock" {tip("clock")}><b>{now}</b><span>{whole}</span></div>'


PANEL = TransportPanel
