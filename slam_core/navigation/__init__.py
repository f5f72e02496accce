"""Section V: the navigation filter, the planar motion model, covariance intersection, aiding sensors."""
