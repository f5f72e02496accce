"""ROS messages to measurements and back, and the tf tree: once, for all sources."""
