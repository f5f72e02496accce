"""Section IV-A, map access: bilinear value and gradient of the occupancy, eqs. (4)-(6)."""

import numpy as np

from slam_core.kernels.bilinear import bilinear_at
from slam_core.measurements import Float32s


def interpolate(probability: Float32s, us: Float32s, vs: Float32s) -> Float32s:
    """M, dM/du and dM/dv at the map coordinates (u right, v up), eqs. (4)-(6).

    probability: (rows, columns), the sample of cell [v, u] lying at (u, v). us, vs: (n,) in cells, within the map.
    Returns (n, 3); gradients per cell.
    """
    rows, columns = probability.shape
    out = np.empty((len(us), 3), np.float32)
    bilinear_at(probability.reshape(-1), rows, columns, us.astype(np.float32), vs.astype(np.float32), out)
    return out
