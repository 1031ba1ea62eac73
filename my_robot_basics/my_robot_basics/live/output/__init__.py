"""What a cell shows: its panel, the ROS logger's lines, exceptions of callbacks."""
