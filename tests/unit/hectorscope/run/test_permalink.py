"""A view as text, there and back, and what is no view."""

from pathlib import Path

import pytest

from hectorscope.run.fingerprint import Identity, identity, size_of
from hectorscope.run.permalink import LONGEST, Permalink, PermalinkError, from_text, to_text
from hectorscope.run.settings import Change, Settings
from slam_core.config import PRESETS, SlamConfig, preset, with_values

RECORDING = Identity(1234, "0123456789abcdef" * 4)
R = f"r={RECORDING.sha256}.{RECORDING.size}"
CHANGED = Settings(
    with_values(
        SlamConfig(),
        {"fusion.omega": 0.25, "matcher.iterations_fine": 3, "map.grow": False, "fusion.method": "trace"},
    )
).changed(1_700_000_000_123_456_789, "fusion.omega", 0.1)


@pytest.mark.parametrize("settings", [Settings(), CHANGED, *(Settings(preset(name)) for name in PRESETS)])
@pytest.mark.parametrize("offset_ns", [0, 1, 12_300_000_000, 3_600_000_000_001])
def test_a_link_holds_the_whole_view(settings: Settings, offset_ns: int) -> None:
    """Recording, time to the nanosecond, name, prior map, settings, changes: each as it was, in a short text."""
    link = Permalink(RECORDING, offset_ns, settings, "a & b=c#1", "ab" * 32)
    text = to_text(link)
    assert from_text(text) == link
    assert len(text) < 500


def test_only_what_differs_is_in_a_link() -> None:
    """The defaults are not named."""
    assert to_text(Permalink(RECORDING, 12_300_000_000, Settings())) == f"{R}&t=12.3"


def test_a_link_that_would_be_too_long_is_not_made() -> None:
    """The remedy is named."""
    many = Settings(SlamConfig(), tuple(Change(n, "fusion.omega", 0.1) for n in range(60)))
    with pytest.raises(PermalinkError, match=r"save config\.toml"):
        to_text(Permalink(RECORDING, 0, many))


@pytest.mark.parametrize(
    "text",
    [
        "", "r=", "t=1", R[:-6], R.upper(), f"{R}&t=-1", f"{R}&t=1e9", f"{R}&t=nan", f"{R}&t=1&t=2", f"{R}&{R}",
        f"{R}&p=other", f"{R}&x=1", f"{R}&s=fusion.omega", f"{R}&s", f"{R}&c=fusion.omega:0.1", f"{R}&c=1:",
        f"{R}&c=2:fusion.omega:0.1&c=1:fusion.omega:0.1", f"{R}&s=" + "[" * 500, f"{R}&n=" + "x" * LONGEST,
        f"{R}&t=" + "9" * 30, f"{R}&c=" + "9" * 30 + ":fusion.omega:0.1", "r=../../etc/passwd&t=1",
        f"{R}&m=1", f"{R}&m=" + "A" * 64,
    ],
)  # fmt: skip
def test_a_damaged_link_is_refused_in_a_sentence(text: str) -> None:
    """Whatever is in it."""
    with pytest.raises(PermalinkError, match=r"^This link cannot be followed: "):
        from_text(text)


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        ("fusion.omega:7", "give 0"),
        ("fusion.omega:NaN", "finite"),
        ("fusion.omega:1e999", "finite"),
        ("fusion.omega:abc", "finite"),
        ("fusion.omega:true", "finite"),
        ("fusion.omeg:0.5", "did you mean fusion.omega"),
        ("map.grow:1", "true or false"),
        ("__class__.x:1", "no setting"),
    ],
)
def test_settings_of_a_link_are_checked_as_if_a_hand_had_set_them(setting: str, reason: str) -> None:
    """Name, type and range, from the start and at a time."""
    for text in (f"{R}&s={setting}", f"{R}&c=5:{setting}"):
        with pytest.raises(PermalinkError, match=reason):
            from_text(text)


def test_a_change_that_a_running_map_cannot_follow_is_refused() -> None:
    """As everywhere."""
    with pytest.raises(PermalinkError, match="set it from the start"):
        from_text(f"{R}&c=5:map.levels:2")


def test_a_recording_is_known_by_its_content(tmp_path: Path) -> None:
    """Not by its place or name; a folder by the names and contents of its files."""
    one, other = tmp_path / "one.bag", tmp_path / "other.bag"
    for path in (one, other):
        path.write_bytes(b"content")
    assert identity(one) == identity(other)
    assert identity(one).size == size_of(one) == 7
    assert identity(one).sha256.startswith("ed7002b439e9ac845f22357d822bac14")
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        folder.mkdir()
        (folder / "metadata.yaml").write_bytes(b"x")
        (folder / "run.db3").write_bytes(b"y")
    assert identity(folders[0]) == identity(folders[1])
    before = identity(folders[0])
    (folders[0] / "run.db3").write_bytes(b"z")
    assert identity(folders[0]) != before
