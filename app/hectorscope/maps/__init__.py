"""Saved maps: our own, and those of ROS map servers."""
