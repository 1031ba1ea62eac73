"""What a process needs to take part in ROS: a domain, its environment, other nodes in it."""
