"""The text of docs/beyond-the-paper.md that holds no figures."""

HEAD = """# Beyond the paper

Written by `python -m benchmarks.additions`; do not edit.

The defaults add to the method of the paper. `SlamConfig.paper()`, `--preset paper` and the choice *Preset* on the
page switch all of these additions off. This document lists them, with what each is worth when it alone is switched
off.
"""

DIFFERS = """## Where `SlamConfig.paper()` differs from the paper

These have no switch.

- The [slips in print](errata.md) are corrected: eqs. (13), (17), (18) and (20).
- The attitude is a quaternion, and its error a small rotation. Eq. (1) with Euler angles is singular at 90 degrees
  of pitch.
- The paper needs an IMU. Without one, a planar filter of nearly constant velocity takes the place of the EKF and
  gives the start estimate; section V-B allows for integrated velocities. `--matcher.start-estimate last_pose`
  starts at the last match instead, as the reference implementation does.
- The paper does not give the rule of the map update, the number of iterations, and the thresholds. They are those
  of the reference implementation: log-odds with one change a cell a scan, 4 iterations on a coarser level and 6 on
  the finest, an update after 0.4 m or 0.06 rad, three levels from 0.05 m.
- Roll and pitch at the start come from the mean acceleration of the first half second.
- The map grows up to `map.limit`. The paper does not say what happens at its edge.
- A measurement acts at its own time: a late match is fused where it belongs, and later samples are propagated
  again. The paper fuses measurements "as soon as they arrive".
- Satellites, compass, distance to the ground and the attitude of another estimator are fused as this project does
  it: "The fusion of other sensors than the scan matching pose is not within the scope of this paper."
- Broken measurements are rejected: values that are no numbers, clipped gyroscopes, frozen sensors, clocks that
  were set.
"""
