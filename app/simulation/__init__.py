"""Worlds, motions and sensors: makes recordings with known truth."""
