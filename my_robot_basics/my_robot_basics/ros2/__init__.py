"""The `ros2` command, for machines that have no ros2cli.

It offers the part of ros2cli (ROS 2 Jazzy) that the course needs, with its syntax, options, output
and exit codes. Each verb is a file in `verbs/` and an entry in `table.py`; `graph.py` is the layer
over rclpy's graph API. Nothing here imports rclpy before a verb needs it.
"""
