"""Tracking state, recovery, global localisation, and prior maps."""
