"""A permalink is followed: the same view is restored, and nothing is lost without asking."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from hectorscope.inputs import Source, SourceOptions
from hectorscope.run.fingerprint import Identity, identity, map_sha256
from hectorscope.run.headless import run_headless
from hectorscope.run.permalink import Permalink
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Agree, Configure, Decline, Follow, Open, Seek, Undo
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.sources import open_source
from slam_core.config import with_value
from slam_core.localization.prior_map import PriorMap, saved_levels
from tests.engines import START, after, state, until

SECOND = 1_000_000_000
FINE = Settings(with_value(START.start, "matcher.iterations_fine", 3))


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two short recordings."""
    folder = tmp_path_factory.mktemp("bags")
    for name, scenario in (("rooms.bag", "rooms"), ("corridor.mcap", "corridor")):
        simulate(SimulateOptions(scenario=scenario, out=folder / name, duration=6.0, scan_rate=10.0, beams=181))  # type: ignore[arg-type]
    return folder


def opened(path: Path, sensors: Mapping[str, Any] = MappingProxyType({})) -> Source:
    return open_source(str(path), SourceOptions(**sensors))


@contextmanager
def session(bags: Path, name: str = "", prior_map: PriorMap | None = None) -> Iterator[Engine]:
    """An engine with the folder, and one of its recordings if there is a name."""
    library = Library(opened, [bags])
    path = bags / name if name else None
    engine = Engine(opened(path) if path else None, START, prior_map, speed=float("inf"))
    library.shown = path
    engine.offer(library)
    engine.start()
    try:
        yield engine
    finally:
        engine.stop()


def at(bags: Path, seconds: float, settings: Settings = START, name: str = "rooms.bag") -> Permalink:
    return Permalink(identity(bags / name), round(seconds * SECOND), settings)


def straight(bags: Path, settings: Settings, scans: int, name: str = "rooms.bag") -> bytes:
    """The first rows of the trajectory of a headless run."""
    return run_headless(opened(bags / name), settings)[0].trajectory[:scans].tobytes()


def seconds(snapshot: Snapshot) -> float:
    return (snapshot.playback.time_ns - snapshot.playback.start_ns) / SECOND


@pytest.mark.parametrize("settings", [START, FINE])
def test_a_link_restores_recording_time_and_settings(bags: Path, settings: Settings) -> None:
    """In a session that has nothing open: it rests at the time, and its rows are those of a straight run."""
    with session(bags) as engine:
        until(engine, state("empty"))
        shown = after(engine, Follow(at(bags, 3.0, settings)))
    assert (shown.source, shown.playback.state, shown.question) == ("rooms.bag", "paused", None)
    assert shown.config == settings.start
    assert 2.9 <= seconds(shown) <= 3.0
    assert shown.trajectory.tobytes() == straight(bags, settings, shown.scans)


def test_changes_over_time_are_restored(bags: Path) -> None:
    """What a run showed after a change at a time, its link shows again elsewhere, to the byte."""
    with session(bags, "rooms.bag") as engine:
        until(engine, state("ended"))
        after(engine, Seek(until(engine, state("ended")).playback.start_ns + 2 * SECOND))
        after(engine, Configure("fusion.omega", 0.2))
        first = after(engine, Seek(engine.mailbox.latest.playback.start_ns + 4 * SECOND))  # type: ignore[union-attr]
        first = until(engine, lambda now: now.recording)
    assert first.ahead.settings.changes
    assert first.recording is not None
    link = Permalink(first.recording, first.playback.time_ns - first.playback.start_ns, first.ahead.settings)
    with session(bags) as engine:
        shown = after(engine, Follow(link))
    assert shown.trajectory.tobytes() == first.trajectory.tobytes()
    assert [image.cells.tobytes() for image in shown.maps] == [image.cells.tobytes() for image in first.maps]
    assert shown.config == first.config


def test_a_link_to_the_same_run_only_goes_to_its_time(bags: Path) -> None:
    """Nothing is opened, nothing begins again, nothing is asked."""
    with session(bags, "rooms.bag") as engine:
        until(engine, state("ended"))
        shown = after(engine, Follow(at(bags, 1.5)))
    assert 1.4 <= seconds(shown) <= 1.5
    assert shown.undo is shown.question is None


def test_settings_that_were_set_by_hand_are_not_lost_unasked(bags: Path) -> None:
    """The question names them; a no keeps all, a yes follows, and an undo brings the run back."""
    with session(bags, "rooms.bag") as engine:
        until(engine, state("ended"))
        before = after(engine, Configure("fusion.omega", 0.2))
        engine.send(Follow(at(bags, 2.0, FINE)))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None and "set by hand" in asked.text
        declined = after(engine, Decline(asked.number))
        engine.send(Follow(at(bags, 2.0, FINE)))
        asked = until(engine, lambda now: now.question).question
        assert asked is not None
        followed = after(engine, Agree(asked.number))
        back = after(engine, Undo())
    assert (declined.epoch, declined.config) == (before.epoch, before.config)
    assert followed.config == FINE.start
    assert back.ahead.settings == before.ahead.settings
    assert back.trajectory.tobytes() == before.trajectory.tobytes()


def test_a_run_that_no_hand_has_changed_gives_way_at_once(bags: Path) -> None:
    """It can be had again as it was; for a minute by an undo."""
    with session(bags, "rooms.bag") as engine:
        until(engine, state("ended"))
        shown = after(engine, Follow(at(bags, 2.0, FINE, "corridor.mcap")))
        assert shown.undo is not None
        again = after(engine, Follow(at(bags, 2.0)))
    assert (shown.source, again.source) == ("corridor.mcap", "rooms.bag")
    assert again.config == START.start


@pytest.mark.parametrize("size", [1, 10**12, None])
def test_an_unknown_recording_is_one_clear_message(bags: Path, size: int | None) -> None:
    """Nothing changes. With the size of one that is there, its content decides."""
    known = identity(bags / "rooms.bag")
    with session(bags, "corridor.mcap") as engine:
        before = until(engine, state("ended"))
        wanted = Identity(known.size if size is None else size, "0" * 64)
        shown = after(engine, Follow(Permalink(wanted, 0, FINE)))
    answers = [entry.text for entry in shown.log if entry.answer]
    assert len(answers) == 1 and answers[0].startswith("The recording of this link (")
    assert "--folder" in answers[0]
    assert (shown.source, shown.epoch, shown.config) == (before.source, before.epoch, before.config)


def test_a_run_with_a_prior_map_is_followed_with_that_map_only(bags: Path) -> None:
    """To the same bytes; a program with another map, with none, or that writes it, says what to start it with."""
    slam = run_headless(opened(bags / "rooms.bag"), START)[0].slam
    prior = PriorMap("rooms", saved_levels(slam.map), start=np.zeros(3))
    link = replace(at(bags, 3.0), map_sha256=map_sha256(prior))
    straight = run_headless(opened(bags / "rooms.bag"), START, prior_map=prior)[0].trajectory
    with session(bags, prior_map=replace(prior, name="a copy of it")) as engine:
        shown = after(engine, Follow(link))
    assert shown.trajectory.tobytes() == straight[: shown.scans].tobytes()
    assert shown.map_sha256 == link.map_sha256
    for other in (None, replace(prior, write=True), replace(prior, start=np.ones(3)), replace(prior, start=None)):
        with session(bags, prior_map=other) as engine:
            engine.send(Follow(link))
            refused = until(engine, lambda now: now.obeyed)
        assert refused.playback.state == "empty"
        assert [entry.text for entry in refused.log if entry.answer and "--map" in entry.text]


def test_a_recording_is_known_by_its_content_once_it_runs(bags: Path) -> None:
    """Whatever opened it; one that is opened from the list too."""
    with session(bags, "rooms.bag") as engine:
        first = until(engine, lambda now: now.recording)
        key = next(each.key for each in first.library if each.name == "corridor.mcap")
        engine.send(Open(key))
        second = until(engine, lambda now: now.source == "corridor.mcap" and now.recording)
    assert first.recording == identity(bags / "rooms.bag")
    assert second.recording == identity(bags / "corridor.mcap")


def test_a_time_beyond_the_end_is_the_end(bags: Path) -> None:
    """As for any jump."""
    with session(bags) as engine:
        shown = after(engine, Follow(at(bags, 1e6)))
    assert shown.playback.time_ns <= (shown.playback.end_ns or 0)
    assert shown.scans > 40
