"""Lines one pixel wide, as a glTF model: drawn in a fraction of the time where there is no graphics card."""

import json
import struct

import numpy as np
from numpy.typing import NDArray

from hectorscope.page.theme import linear
from slam_core.measurements import Float32s

LINES = 1  # primitive of glTF 2.0: two points each
FLOAT = 5126


def model(segments: Float32s, colour: NDArray[np.uint8]) -> bytes:
    """The GLB file (glTF 2.0, 4.4) of segments (n, 2, 3), in metres, of one colour (3,) in sRGB."""
    points = segments.reshape(-1, 3)
    told = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": LINES, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [*linear(colour).tolist(), 1.0]}}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": FLOAT,
                "type": "VEC3",
                "count": len(points),
                "min": points.min(axis=0).tolist(),
                "max": points.max(axis=0).tolist(),
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": points.nbytes}],
        "buffers": [{"byteLength": points.nbytes}],
    }
    words = json.dumps(told).encode()
    words += b" " * (-len(words) % 4)
    chunks = b"".join(
        struct.pack("<I4s", len(data), kind) + data
        for kind, data in ((b"JSON", words), (b"BIN\0", points.astype("<f4").tobytes()))
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
