"""ROS 2 topics on a two-link arm: what the lessons import, run and extend."""
