"""The bar at the bottom: play, pause, step, restart, undo, speed, and the same as hotkeys.

A stream has no steps and no speed: it shows none of them, except while an earlier time of it is shown.
"""

import math
from collections.abc import Callable
from time import monotonic
from typing import Any, cast

from viser import GuiEvent, Icon, IconName

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._controls import by_hand
from hectorscope.panels._format import clock, tip
from hectorscope.panels._handles import put, put_value, show
from hectorscope.session.commands import (
    ChangeSpeed,
    GoLive,
    PlayPause,
    Restart,
    Save,
    SetSpeed,
    StepBack,
    StepScan,
    Undo,
)
from hectorscope.session.playback import ON_OFFER, nearest_speed
from hectorscope.session.snapshot import PlaybackStatus, Snapshot, UndoOffer

SPEEDS = {f"{speed:g}×" if math.isfinite(speed) else "max": speed for speed in ON_OFFER}
RUNNING = ("playing", "seeking", "waiting")
LONGEST = 28  # characters of what an undo takes back


class TransportPanel:
    """Callbacks send commands; `draw` follows what the run really does."""

    title = "Transport"
    order = 10
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._speed_drawn = ""
        gui = scene.server.gui
        with _workspace.bar(scene, "transport"):
            self._restart = gui.add_button("Restart · R", icon=Icon.PLAYER_SKIP_BACK_FILLED)
            self._toggle = gui.add_button("Play · space", icon=Icon.PLAYER_PLAY_FILLED)
            self._step = gui.add_button("Step one scan · .", icon=Icon.PLAYER_TRACK_NEXT_FILLED)
            self._save = gui.add_button("Save the results", icon=Icon.DEVICE_FLOPPY, visible=False)
            gui.add_html('<i class="hs-mark hs-undo"></i>')
            self._undo = gui.add_button("Undo · U", icon=Icon.ARROW_BACK_UP, visible=False)
            self._now = gui.add_button("Now · L", icon=Icon.BROADCAST, visible=False)
            self._clock = gui.add_html("")
            self._speed = gui.add_dropdown(
                "Speed", tuple(SPEEDS), initial_value="1×", hint="Times real time. Keys [ and ]."
            )
        self._restart.on_click(lambda _: scene.send(Restart()))
        self._toggle.on_click(lambda _: scene.send(PlayPause()))
        self._step.on_click(lambda _: scene.send(StepScan()))
        self._save.on_click(lambda _: scene.send(Save()))
        self._now.on_click(lambda _: scene.send(GoLive()))
        self._undo.on_click(lambda _: scene.send(Undo()))
        self._speed.on_update(by_hand(self._choose_speed))
        self._add_hotkeys()

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the run."""
        playback = snapshot.playback
        running = playback.state in RUNNING
        label = "Pause · space" if running else "Play · space"
        if self._toggle.label != label:
            self._toggle.label = label
            self._toggle.icon = Icon.PLAYER_PAUSE_FILLED if running else Icon.PLAYER_PLAY_FILLED
        show(self._save, snapshot.saves)
        for control in (self._step, self._speed):
            show(control, not playback.live or playback.lag is not None)
        show(self._now, playback.lag is not None)
        self._draw_undo(snapshot.undo, monotonic())
        self._draw_speed(name_of_speed(playback.speed))
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
        if event.target.value in SPEEDS:
            self._scene.send(SetSpeed(SPEEDS[event.target.value]))

    def _add_hotkeys(self) -> None:
        send = self._scene.send
        self._hotkey("Play or pause", "space", Icon.PLAYER_PLAY, lambda: send(PlayPause()))
        self._hotkey("Step one scan", ".", Icon.PLAYER_TRACK_NEXT, lambda: send(StepScan()))
        self._hotkey("Back one scan", ",", Icon.PLAYER_TRACK_PREV, lambda: send(StepBack()))
        self._hotkey("Restart", "R", Icon.PLAYER_SKIP_BACK, lambda: send(Restart()))
        self._hotkey("Back to now, of a stream", "L", Icon.BROADCAST, lambda: send(GoLive()))
        self._hotkey("Undo", "U", Icon.ARROW_BACK_UP, lambda: send(Undo()))
        self._hotkey("Slower", "[", Icon.MINUS, lambda: send(ChangeSpeed(-1)))
        self._hotkey("Faster", "]", Icon.PLUS, lambda: send(ChangeSpeed(+1)))

    def _hotkey(self, title: str, key: str, icon: IconName, act: Callable[[], None]) -> None:
        # The page takes any key that a keyboard event names; the declared type lists letters and a few more.
        command = self._scene.server.gui.add_command(title, hotkey=cast(Any, key), icon=icon)
        command.on_trigger(lambda _: act())


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
