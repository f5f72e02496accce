"""Pictures of marks: what a browser sends is decoded, made small, and encoded anew; nothing else of it remains."""

import hashlib
import io
from dataclasses import dataclass

from PIL import Image, ImageOps

from slam_core.errors import SlamError

MOST_SENT = 44_000  # bytes that a browser sends: one request holds them, and a page makes them so few
MOST_PIXELS = 1 << 22  # of one that is decoded: some 40 ms of the engine
LARGEST = 1024  # pixels of the longer side of one that is kept
QUALITIES = (80, 60, 40)
MOST_KEPT = 200_000  # bytes
FORMATS = ("JPEG", "PNG", "WEBP")


class PictureError(SlamError):
    """What was sent is no picture that could be kept."""


@dataclass(frozen=True, slots=True)
class Picture:
    """content: a JPEG without metadata. key: tells pictures apart."""

    content: bytes
    key: str


def picture_of(sent: bytes) -> Picture:
    """What a browser sent as a picture of ours; PictureError if it is none."""
    if len(sent) > MOST_SENT:
        raise PictureError(
            f"The picture has {len(sent)} bytes, and {MOST_SENT} are taken: choose it on the page, which makes it"
            " smaller"
        )
    content = _encoded(_decoded(sent))
    return Picture(content, hashlib.sha256(content).hexdigest()[:16])


def _decoded(sent: bytes) -> Image.Image:
    """The pixels, turned as the camera was held."""
    try:
        with Image.open(io.BytesIO(sent), formats=FORMATS) as opened:
            if opened.width * opened.height > MOST_PIXELS:
                raise PictureError(
                    f"The picture has {opened.width} x {opened.height} pixels, and {MOST_PIXELS} are taken:"
                    " make it smaller"
                )
            image = ImageOps.exif_transpose(opened).convert("RGB")
    except PictureError:
        raise
    except Exception as error:  # a decoder raises what it likes
        raise PictureError(
            "What was sent cannot be read as a picture: choose a whole JPEG, PNG or WebP"
        ) from error
    image.thumbnail((LARGEST, LARGEST))
    return image


def _encoded(image: Image.Image) -> bytes:
    """The best quality that is small enough."""
    bare = Image.frombytes("RGB", image.size, image.tobytes())  # nothing but pixels
    for quality in QUALITIES:
        content = io.BytesIO()
        bare.save(content, "JPEG", quality=quality)
        if content.tell() <= MOST_KEPT:
            return content.getvalue()
    raise PictureError(f"The picture takes more than {MOST_KEPT} bytes: choose one with less detail")
