"""What the matcher does with one scan: its iterations, its cost, its covariances. Values without drawing."""

from typing import Literal

Plane = Literal["xy", "xyaw"]
"""Of a landscape: what lies along its two axes."""
