"""Section IV-B: scan matching by Gauss-Newton, and the correlative search."""
