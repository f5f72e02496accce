"""ROS messages of either generation to measurements: once, for recordings and live streams alike."""
