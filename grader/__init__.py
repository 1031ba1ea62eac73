"""Grades notebooks of my_robot_basics: a test is just another ROS node."""
