"""Pictures as cameras and browsers write them."""

import io
import random

from PIL import Image


def picture_bytes(size: tuple[int, int] = (64, 48), kind: str = "JPEG", **saving: object) -> bytes:
    """A picture, red at the left and blue at the right."""
    image = Image.new("RGB", size, (220, 20, 20))
    image.paste((20, 20, 220), (size[0] // 2, 0, *size))
    content = io.BytesIO()
    image.save(content, kind, **saving)  # type: ignore[arg-type]
    return content.getvalue()


def noise_bytes(size: tuple[int, int]) -> bytes:
    """A JPEG of noise, which no encoder makes small."""
    content = io.BytesIO()
    Image.frombytes("L", size, random.Random(1).randbytes(size[0] * size[1])).save(content, "JPEG", quality=95)
    return content.getvalue()
