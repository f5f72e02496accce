"""Maps on the disk that cannot be used, and which file of a folder is taken."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from hectorscope.maps.saved_map import load_map, to_npz
from slam_core.config import MapConfig
from slam_core.localization.prior_map import MapError, SavedLevel

CONFIG = MapConfig(levels=2)
LEVELS = tuple(
    SavedLevel(
        0.05 * 2**i,
        np.array([-40, 20]) >> i,
        np.full((8 >> i, 12 >> i), 1.5, np.float32),
        None if i else np.arange(96, dtype=np.uint32).reshape(8, 12),
    )
    for i in range(2)
)


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    """A folder with a map of two levels."""
    (tmp_path / "map.npz").write_bytes(to_npz(LEVELS))
    return tmp_path


def packed(**arrays: object) -> bytes:
    """Arrays as the file holds them."""
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


def refused(path: Path, config: MapConfig = CONFIG) -> str:
    """What is said about a map that cannot be used."""
    with pytest.raises(MapError) as caught:
        load_map(path, config)
    return str(caught.value)


def test_a_folder_and_its_file_are_the_same(saved: Path):
    """Exact cells are taken before the image beside them."""
    (saved / "map.yaml").write_text("image: none.pgm")
    for path in (saved, saved / "map.npz"):
        given = load_map(path, CONFIG, write=True, start=np.array([1.0, 2.0, 3.0]))
        assert given.write
        assert given.start is not None
        assert given.start.tolist() == [1, 2, 3]
        assert [level.log_odds.shape for level in given.levels] == [(8, 12), (4, 6)]


def test_settings_that_do_not_fit_are_named(saved: Path):
    """Levels and resolution, with the flags that would fit."""
    message = "2 levels from 0.05 m up"
    for config in (MapConfig(levels=3), MapConfig(levels=2, resolution=0.1)):
        assert message in refused(saved, config)
        assert "set map.levels to 2 and map.resolution to 0.05" in refused(saved, config)


def test_a_map_for_which_there_is_no_room_is_refused(tmp_path: Path):
    """Before it is unpacked, by its own figures, and as a pyramid."""
    large = tuple(
        SavedLevel(0.05 * 2**i, np.zeros(2, np.int64), np.ones((1000 >> i,) * 2, np.float32)) for i in (0, 1)
    )
    (tmp_path / "map.npz").write_bytes(to_npz(large))
    assert "unpacks to 5 MB: raise --map.limit" in refused(tmp_path, MapConfig(levels=2, limit=4.0))
    given = load_map(tmp_path, CONFIG)
    with pytest.raises(MapError, match=r"raise map\.limit"):
        given.pyramid(MapConfig(levels=2, size=64, limit=5.2))


def test_what_is_not_there_is_named(tmp_path: Path):
    """No such path, a name that none can have, a folder without a map, a folder with two."""
    assert "nowhere does not exist" in refused(tmp_path / "nowhere")
    assert "cannot be reached (File name too long): give the folder" in refused(tmp_path / ("x" * 300))
    assert "neither map.npz nor a .yaml" in refused(tmp_path)
    for name in ("a.yaml", "b.yaml"):
        (tmp_path / name).write_text("")
    assert "holds a.yaml, b.yaml" in refused(tmp_path)


def test_every_cut_is_noticed(saved: Path):
    """A file that ends anywhere before its end."""
    file = saved / "map.npz"
    whole = file.read_bytes()
    for length in (0, 1, 30, len(whole) // 2, len(whole) - 1):
        file.write_bytes(whole[:length])
        assert "map.npz is damaged or no map" in refused(saved)


def test_no_changed_byte_makes_another_map(saved: Path):
    """Wherever a byte is wrong, the map is refused, or its cells are the right ones all the same."""
    file = saved / "map.npz"
    whole = file.read_bytes()
    noticed = 0
    for place in range(0, len(whole), 5):
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            assert to_npz(load_map(saved, CONFIG).levels) == whole
        except MapError:
            noticed += 1
    assert noticed > len(whole) // 25


@pytest.mark.parametrize(
    "changed",
    [
        {"version": None},
        {"version": np.array([1, 2])},
        {"version": np.array(1j)},
        {"version": np.array(np.inf)},
        {"resolutions": np.array([0.05, np.nan])},
        {"resolutions": np.array(0.05)},
        {"resolutions": np.ones((2, 2))},
        {"resolutions": np.array(["2020-01-01"] * 2, dtype="M8[D]")},
        {
            "resolutions": np.array([]),
            **dict.fromkeys(("corner0", "log_odds0", "surfels0", "corner1", "log_odds1")),
        },
        {"corner1": np.array([0.5, 0.0])},
        {"corner0": np.zeros(3, np.int64)},
        {"log_odds0": np.ones(5, np.float32)},
        {"log_odds0": np.ones((3, 3))},
        {"log_odds1": np.full((4, 6), np.nan, np.float32)},
        {"log_odds1": np.ones((0, 6), np.float32)},
        {"surfels0": np.ones((8, 11), np.uint32)},
        {"surfels0": np.ones((8, 12), np.int64)},
    ],
)
def test_arrays_that_are_no_map_are_refused(saved: Path, changed: dict[str, object]):
    """A good archive with other things in it."""
    with np.load(saved / "map.npz") as arrays:
        entries = {**arrays, **changed}
    (saved / "map.npz").write_bytes(
        packed(**{name: value for name, value in entries.items() if value is not None})
    )
    assert "is damaged or no map" in refused(saved)


@pytest.mark.parametrize(
    "changed",
    [
        {"resolutions": np.array([0.05, 0.05])},
        {"corner1": LEVELS[1].corner + 1000},
        {"corner1": LEVELS[1].corner - (3, 0)},
        {"log_odds1": np.ones((40, 8), np.float32)},
    ],
)
def test_levels_that_are_no_pyramid_are_refused(saved: Path, changed: dict[str, np.ndarray]):
    """A coarser level that is not half as fine, or lies elsewhere than the finest."""
    with np.load(saved / "map.npz") as arrays:
        (saved / "map.npz").write_bytes(packed(**{**arrays, **changed}))
    assert "level 1 does not cover level 0 with cells 2 times as large" in refused(saved)


@pytest.mark.parametrize("shape", ["(99999999, 9999999)", "((((, ", f"({10**30},)"])
def test_an_array_whose_header_is_wrong_is_refused(saved: Path, shape: str):
    """More cells than any memory holds, brackets that never close, a size beyond all whole numbers."""
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    with zipfile.ZipFile(saved / "map.npz") as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    entries["log_odds0.npy"] = np.lib.format.magic(1, 0) + len(header).to_bytes(2, "little") + header + bytes(100)
    with zipfile.ZipFile(saved / "map.npz", "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    assert "is damaged or no map" in refused(saved)


def test_a_map_from_before_there_were_surfels_is_taken(saved: Path):
    """Its cells are the same; where in them a surface lies is not known."""
    with np.load(saved / "map.npz") as arrays:
        (saved / "map.npz").write_bytes(packed(**{k: v for k, v in arrays.items() if k != "surfels0"}))
    finest = load_map(saved, CONFIG).levels[0]
    assert finest.surfels is None
    assert (finest.log_odds == LEVELS[0].log_odds).all()


def test_another_version_is_named(saved: Path):
    """What a later program may write."""
    (saved / "map.npz").write_bytes(packed(version=np.array(3), resolutions=np.array([0.05])))
    assert "is of version 3" in refused(saved)
