"""Pictures of marks: only pixels remain of what a browser sends, and only so many."""

import io
import warnings

import pytest
from PIL import Image, ImageOps

from hectorscope.run.annotations import MOST_BYTES, AnnotationError, Annotations
from hectorscope.run.pictures import LARGEST, MOST_KEPT, MOST_SENT, Picture, PictureError, picture_of
from tests.pictures import noise_bytes, picture_bytes

SECRET = b"48 degrees north, the house of the operator"


def opened(picture: Picture) -> Image.Image:
    """As a reader takes it."""
    image = Image.open(io.BytesIO(picture.content))
    image.load()
    return image


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP"])
def test_a_picture_is_encoded_anew_without_metadata(kind: str) -> None:
    """Its place, its comments and whatever hangs behind it are gone; it is turned as the camera was held."""
    exif = Image.Exif()
    exif[0x010E], exif[0x0112] = SECRET.decode(), 6  # description; a quarter turn
    picture = picture_of(picture_bytes(kind=kind, exif=exif) + SECRET)
    image = opened(picture)
    assert (image.format, image.size) == ("JPEG", (48, 64))
    assert SECRET not in picture.content
    assert not image.getexif()
    red, blue = image.getpixel((24, 8)), image.getpixel((24, 56))
    assert isinstance(red, tuple) and isinstance(blue, tuple)
    assert red[0] > 150 > red[2] and blue[2] > 150 > blue[0]


def test_a_large_picture_is_made_small() -> None:
    """In pixels and in bytes."""
    picture = picture_of(picture_bytes((2800, 1400), "PNG"))
    assert opened(picture).size == (LARGEST, LARGEST // 2)
    assert len(picture.content) <= MOST_KEPT


@pytest.mark.parametrize(
    ("sent", "why"),
    [
        (b"", "cannot be read as a picture"),
        (b"../../etc/passwd", "cannot be read as a picture"),
        (b"<svg xmlns='http://www.w3.org/2000/svg'><script>alert(1)</script></svg>", "cannot be read"),
        (picture_bytes(kind="GIF"), "choose a whole JPEG, PNG or WebP"),
        (picture_bytes((400, 400))[:-200], "cannot be read as a picture"),
        (picture_bytes(kind="PNG")[:60], "cannot be read as a picture"),
        (noise_bytes((400, 400)), f"bytes, and {MOST_SENT} are taken"),
        (picture_bytes((6000, 4000), "WEBP", quality=1), "6000 x 4000 pixels"),
    ],
    ids=["empty", "a path", "a drawing", "another format", "cut", "cut early", "too large", "too many pixels"],
)
def test_what_is_no_picture_is_refused_with_the_reason(sent: bytes, why: str) -> None:
    """Damaged, of another kind, too large in bytes or pixels."""
    with pytest.raises(PictureError, match=why):
        picture_of(sent)


def test_pictures_of_a_run_are_bounded() -> None:
    """All together; another one in place of the first takes no more room."""
    marks = Annotations()
    for number in (1, 2):
        marks = marks.put("note", number, (0.0, 0.0), (0.0, 0.0, 0.0), "")
    large = Picture(bytes(MOST_BYTES - 10), "a")
    marks = marks.pictured(1, large).pictured(1, large)
    with pytest.raises(AnnotationError, match="more than 16 MiB: remove some marks"):
        marks.pictured(2, Picture(bytes(11), "b"))
    assert marks.pictured(2, Picture(bytes(10), "b"))[2].picture is not None
    with pytest.raises(AnnotationError, match="no mark 9"):
        marks.pictured(9, large)


def test_a_kept_run_knows_its_marks_with_and_without_their_pictures() -> None:
    """Its file has no pictures: joined with it, no mark is there twice."""
    bare = Annotations().put("note", 1, (0.0, 0.0), (0.0, 0.0, 0.0), "")
    pictured = bare.pictured(1, picture_of(picture_bytes()))
    assert pictured.joined(bare) == pictured


def test_warnings_of_other_threads_stay_warnings(monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture is decoded with the filters of warnings as they are, since these are those of the process."""
    decode, before, during = ImageOps.exif_transpose, list(warnings.filters), []

    def observed(image: Image.Image) -> Image.Image:
        during.extend(warnings.filters)
        return decode(image)

    monkeypatch.setattr(ImageOps, "exif_transpose", observed)
    picture_of(picture_bytes())
    assert during == before
