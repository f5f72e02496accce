"""What a page shows of the operator's station."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.annotations import Annotation


@dataclass(frozen=True, slots=True, eq=False)
class StationState:
    """records: whether the stream is recorded; None if there is no folder for that. recorded: bytes so far.

    annotations: marks that a person set. way_back: (n, 2) to the start; None while it is not shown.
    warnings: what cannot be written, with the remedies. past: whether a run before can be gone on with.
    """

    annotations: tuple[Annotation, ...] = ()
    way_back: NDArray[np.float64] | None = None
    records: bool | None = None
    recorded: int = 0
    warnings: tuple[str, ...] = ()
    past: bool = False
