"""The `ros2` command, for machines that have no ros2cli.

It offers what the course needs of ros2cli (ROS 2 Jazzy), with its syntax, options, output and
exit codes. One verb a file in `verbs/`, one table (`table.py`), one layer over rclpy's graph API
(`graph.py`). Nothing here imports rclpy before a verb needs it.
"""
