"""Errors of a trajectory against the truth."""
