"""Cases of a parametrized test of which only some are run by .ci/run, which has little time."""

from collections.abc import Iterable
from typing import Any

import pytest


def quick_first(values: Iterable[Any], quick: int = 1, ids: Iterable[str] | None = None) -> list[Any]:
    """The first `quick` of the values as they are, all others marked slow; the ids are those of pytest's own."""
    values = list(values)
    names = list(ids) if ids is not None else [None] * len(values)
    return [
        pytest.param(value, id=name, marks=[pytest.mark.slow] if place >= quick else [])
        for place, (value, name) in enumerate(zip(values, names, strict=True))
    ]
