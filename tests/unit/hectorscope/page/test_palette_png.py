"""The palette PNG, read back by another decoder."""

import io

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from hectorscope.page.palette_png import encode

PALETTE = ((10, 20, 30), (40, 50, 60), (250, 240, 230))
ALPHA = (0, 70, 255)
CLASSES = st.tuples(st.integers(1, 40), st.integers(1, 40)).flatmap(
    lambda shape: arrays(np.uint8, shape, elements=st.integers(0, 2))
)


@given(CLASSES)
def test_pillow_reads_the_same_classes(cells: np.ndarray) -> None:
    """Every cell comes back as the class that went in, for every width and height."""
    image = Image.open(io.BytesIO(encode(cells, PALETTE, ALPHA)))
    assert image.mode == "P"
    assert np.array_equal(np.asarray(image), cells)


@given(CLASSES)
def test_each_class_has_its_colour_and_opacity(cells: np.ndarray) -> None:
    """Decoded to RGBA, unknown is transparent and the others have their colour and opacity."""
    rgba = np.asarray(Image.open(io.BytesIO(encode(cells, PALETTE, ALPHA))).convert("RGBA"))
    expected = np.column_stack([np.array(PALETTE), np.array(ALPHA)]).astype(np.uint8)[cells]
    assert np.array_equal(rgba, expected)


def test_the_input_is_left_alone() -> None:
    """A snapshot's cells are shared with others: encoding a read-only array works and changes nothing."""
    cells = np.arange(12, dtype=np.uint8).reshape(3, 4) % 3
    cells.flags.writeable = False
    encode(cells, PALETTE, ALPHA)


def test_a_large_map_is_small() -> None:
    """A map of 1024 x 1024 cells with walls costs less than 30 kB."""
    cells = np.ones((1024, 1024), np.uint8)
    cells[::64] = 2
    cells[:, ::64] = 2
    assert len(encode(cells, PALETTE, ALPHA)) < 30_000
