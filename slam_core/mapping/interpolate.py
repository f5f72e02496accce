"""Section IV-A, map access: bilinear value and gradient of the occupancy, eqs. (4)-(6)."""

import numpy as np
from numpy.typing import NDArray

from slam_core.kernels.bilinear import WHOLE, bilinear_at
from slam_core.measurements import Float32s


def interpolate(cells: NDArray[np.int16], us: Float32s, vs: Float32s) -> Float32s:
    """M, dM/du and dM/dv at the map coordinates (u right, v up), eqs. (4)-(6).

    cells: (rows, columns) as in GridLevel, the sample of cell [v, u] lying at (u, v). us, vs: (n,) in cells,
    within the map. Returns (n, 3); gradients per cell.
    """
    rows, columns = cells.shape
    out = np.empty((len(us), 3), np.float32)
    bilinear_at(cells.reshape(-1), rows, columns, us.astype(np.float32), vs.astype(np.float32), out)
    return out / np.float32(WHOLE)
