"""Maps that other tools wrote: an image and what a yaml file says of it."""

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hectorscope.maps.ros_map import coarser, read_ros_map
from slam_core.config import MapConfig
from slam_core.localization.prior_map import MapError, SavedLevel

CONFIG = MapConfig(levels=1, resolution=0.5)
# As the image shows it, top row first: occupied, free and unknown greys.
GREYS = np.array([[0, 254, 205], [254, 254, 205]], np.uint8)
SAID = """image: some.pgm
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def written(folder: Path, said: str = SAID, image: bytes | None = None) -> Path:
    """The yaml file of a map in a folder."""
    head = f"P5\n# made by a tool\n{GREYS.shape[1]} {GREYS.shape[0]}\n255\n".encode()
    (folder / "some.pgm").write_bytes(head + GREYS.tobytes() if image is None else image)
    (folder / "some.yaml").write_text(said)
    return folder / "some.yaml"


def png(image: Image.Image) -> bytes:
    """The content of a PNG file."""
    file = io.BytesIO()
    image.save(file, "png")
    return file.getvalue()


def known(level: SavedLevel) -> dict[tuple[int, int], int]:
    """Sign of every known cell by its column and row in the lattice."""
    return {
        (int(level.corner[0] + u), int(level.corner[1] + v)): int(np.sign(level.log_odds[v, u]))
        for v, u in np.argwhere(level.log_odds != 0)
    }


EXPECTED = {(-2, 5): 1, (-1, 5): -1, (-2, 4): -1, (-1, 4): -1}


def test_each_pixel_is_a_cell_of_the_lattice(tmp_path: Path):
    """The corner in whole cells, the highest row on top, the greys by their thresholds."""
    (level,) = read_ros_map(written(tmp_path), CONFIG)
    assert known(level) == EXPECTED
    assert level.resolution == 0.5


@pytest.mark.parametrize(
    "said",
    [
        SAID.replace("origin: [-1.0, 2.0, 0.0]", "origin:\n- -1.0\n- 2.0\n- 0.0"),
        SAID.replace("occupied_thresh: 0.65\nfree_thresh: 0.196\n", "mode: trinary\n"),
        SAID.replace("-1.0, 2.0", "-0.9999999999, 2.0000000001"),
        SAID.replace("-1.0, 2.0", "-0.9, 1.9"),  # a part of a cell: the nearest pixel
    ],
)
def test_other_ways_to_say_it(tmp_path: Path, said: str):
    """A list over lines, defaults, rounded corners, corners between cells."""
    assert known(read_ros_map(written(tmp_path, said), CONFIG)[0]) == EXPECTED


def test_plain_and_negated_images(tmp_path: Path):
    """P2 is P5 in words; negate turns black into free."""
    plain = b"P2 3 2 255 " + b" ".join(b"%d" % grey for grey in GREYS.ravel())
    assert known(read_ros_map(written(tmp_path, image=plain), CONFIG)[0]) == EXPECTED
    negated = b"P5 3 2 255 " + (255 - GREYS).tobytes()
    said = SAID.replace("negate: 0", "negate: 1")
    assert known(read_ros_map(written(tmp_path, said, negated), CONFIG)[0]) == EXPECTED


@pytest.mark.parametrize("mode", ["L", "P", "RGB", "RGBA"])
def test_a_png_is_read(tmp_path: Path, mode: str):
    """Grey, by a palette or in colour: the same cells."""
    said = SAID.replace("some.pgm", "some.png")
    file = written(tmp_path, said)
    (tmp_path / "some.png").write_bytes(png(Image.fromarray(GREYS).convert(mode)))
    assert known(read_ros_map(file, CONFIG)[0]) == EXPECTED


def test_what_is_transparent_is_unknown(tmp_path: Path):
    """Whatever colour it has."""
    pixels = np.stack([GREYS, np.array([[255, 0, 255], [255, 255, 255]], np.uint8)], axis=-1)
    (level,) = read_ros_map(written(tmp_path, image=png(Image.fromarray(pixels))), CONFIG)
    assert known(level) == {cell: sign for cell, sign in EXPECTED.items() if cell != (-1, 5)}


def test_a_turned_map_is_turned(tmp_path: Path):
    """A quarter turn to the left about the corner of the image."""
    (level,) = read_ros_map(written(tmp_path, SAID.replace("2.0, 0.0]", "2.0, 1.5707963267948966]")), CONFIG)
    turned = {(-2 - (v - 4) - 1, 4 + (u + 2)): sign for (u, v), sign in EXPECTED.items()}
    assert known(level) == turned


def test_coarser_levels_share_the_lattice(tmp_path: Path):
    """Corners are halved exactly, a cell with a wall in it is a wall, one with none but free is free."""
    levels = read_ros_map(written(tmp_path), MapConfig(levels=3, resolution=0.5))
    assert [level.resolution for level in levels] == [0.5, 1.0, 2.0]
    assert known(levels[1]) == {(-1, 2): 1}
    assert known(levels[2]) == {(-1, 1): 1}
    free = SavedLevel(1.0, np.zeros(2, np.int64), np.array([[-3.0, 0.0], [0.0, 0.0]], np.float32))
    assert coarser(free).log_odds.tolist() == [[-3.0]]


@pytest.mark.parametrize(
    ("said", "image", "reason"),
    [
        (SAID, b"P5 3 2 255 ab", "cannot be read .*truncated"),
        (SAID, b"P5 3 2 255", "cannot be read .*truncated"),
        (SAID, b"P5 three", "some.pgm cannot be read"),
        (SAID, b"P5 3 2 65535 " + bytes(12), "save it with 8 bits a channel"),
        (SAID, b"P2 2 1 255 1 999", "some.pgm cannot be read"),
        (SAID, b"P5 -3 -2 255 " + bytes(6), "no image in PPM, PNG, BMP"),
        (SAID, b"P2 2 1 255 0 -5", "Channel value is negative"),
        (SAID, b"P2 2 1 255 0 99999999999999999999999", "some.pgm cannot be read"),
        (SAID, b"\x89PNG", "no image in PPM, PNG, BMP"),
        (SAID, png(Image.fromarray(GREYS))[:45], "some.pgm cannot be read"),
        (SAID, png(Image.fromarray(GREYS.astype(np.uint16))), "save it with 8 bits a channel"),
        (SAID, b"P5 2 1 255 \xfe\xfe", "not one occupied cell"),
        (SAID.replace("some.pgm", "other.pgm"), None, "other.pgm does not exist"),
        (SAID.replace("some.pgm", "some.pmg"), None, r"did you mean .*some\.pgm\?"),
        (SAID.replace("0.5", "0.05"), None, "give --map.resolution 0.05"),
        (SAID + "mode: raw\n", None, "raw mode"),
        (SAID.replace("-1.0, 2.0, 0.0", "-1.0, 2.0"), None, r"origin is \[-1.0, 2.0\]: give \[x, y, yaw\]"),
        (SAID.replace("-1.0,", ".nan,"), None, "the x of its origin is nan: give"),
        (SAID.replace("-1.0,", "1e9,"), None, "the x of its origin is 1000000000.0: give -100000 to 100000"),
        (SAID.replace("0.5", "-0.5"), None, "resolution is -0.5: give 0.0001 to 100"),
        (SAID.replace("0.5", "half"), None, "resolution is 'half': give"),
        (SAID.replace("resolution", "size"), None, "it needs image, resolution"),
        (SAID.replace("0.5", "9" * 400), None, "resolution is 9+.*: give"),
        (SAID.replace("negate: 0", "negate: x"), None, "negate is 'x': give 0 or 1"),
        (SAID.replace("0.196", "0.7"), None, "free_thresh is 0.7 and occupied_thresh 0.65: the second must be"),
        (SAID.replace("0.196", "[0.1]"), None, r"free_thresh is \[0.1\]: give 0 to 1"),
        (SAID.replace("some.pgm", "[1]"), None, r"image is \[1\]: give the name of a file"),
        (SAID.replace("0.5", "9" * 5000), None, "cannot be read"),
        (SAID.replace("some.pgm", r'"a\0b"'), None, "cannot be read"),
        (SAID + "x: 2020-99-99\n", None, "cannot be read"),
        (SAID + "x: !!bool maybe\n", None, "cannot be read"),
        (SAID + "x: !!int maybe\n", None, "cannot be read"),
        ("[" * 1000, None, "cannot be read"),
        ("image: [\n", None, "cannot be read"),
        ("only words", None, "describes no map"),
        ("", None, "describes no map"),
    ],
)
def test_what_cannot_be_used_is_named(tmp_path: Path, said: str, image: bytes | None, reason: str):
    """The file, what is wrong with it, and what to do."""
    with pytest.raises(MapError, match=reason):
        read_ros_map(written(tmp_path, said, image), CONFIG)


def test_a_header_may_have_any_number_of_comments(tmp_path: Path):
    """Each is read once."""
    head = b"P5\n" + b"#\n" * 100_000 + f"{GREYS.shape[1]} # wide\n{GREYS.shape[0]}\n255\n".encode()
    (level,) = read_ros_map(written(tmp_path, image=head + GREYS.tobytes()), CONFIG)
    assert known(level) == EXPECTED


LAUGHS = "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12))


@pytest.mark.parametrize(
    ("said", "image", "reason"),
    [
        (LAUGHS + SAID.replace("some.pgm", "*a11"), None, r"image is \[\[\.\.\.\], .*: give the name of a file"),
        (LAUGHS + SAID.replace("0.5", "*a11"), None, r"resolution is \[\[\.\.\.\], .*: give"),
        (SAID + "#" * 70_000, None, "more than 65536 bytes"),
        (
            SAID.replace("0.0]", "0.7]"),
            b"P5 20000 1 255\n" + bytes(20_000),
            r"turned by 0\.7 rad: raise --map\.limit",
        ),
        (SAID, b"P5 99999 99999 255\n", "99999 x 99999 pixels, more than 100000 cells: raise --map.limit"),
        (SAID, b"P2 2 2 255\n" + b" " * 900_000, "too many for 100000 cells"),
    ],
    ids=["image", "resolution", "long", "turned", "large", "plain"],
)
def test_what_would_take_all_memory_is_refused(tmp_path: Path, said: str, image: bytes | None, reason: str):
    """A small file may describe more than fits: the limit of the map holds for it too."""
    with pytest.raises(MapError, match=reason):
        read_ros_map(written(tmp_path, said, image), replace(CONFIG, limit=1.0))
