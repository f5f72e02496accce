"""Invisible elements that tell the scripts of the page what is in the scene."""

import html
import json
from collections.abc import Sequence

from hectorscope.page.scene import Layer


def layers_mark(layers: Sequence[tuple[Layer, str]]) -> str:
    """An invisible element that tells static/dress.js the layers, each with the button that asks for it."""
    described = {
        layer.key: {"nodes": [layer.root.name, *layer.more], "shown": layer.shown, "ask": ask}
        for layer, ask in layers
    }
    return f'<i class="hs-mark" data-hs-layers="{html.escape(json.dumps(described))}"></i>'


def levels_mark(resolutions: Sequence[float]) -> str:
    """An invisible element that tells static/levels.js how large the cells of each level are."""
    return f'<i class="hs-mark" data-hs-levels="{json.dumps(list(resolutions))}"></i>'
