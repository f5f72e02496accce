"""The results of a run as messages of ROS 2: what goes to which topic, and when."""
