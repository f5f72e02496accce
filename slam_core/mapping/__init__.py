"""Sections IV-A and IV-C: occupancy grids, the pyramid, and what is written into them when."""
