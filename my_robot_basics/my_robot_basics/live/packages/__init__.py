"""A ROS package of the student's: its workspace, its build, its processes."""
