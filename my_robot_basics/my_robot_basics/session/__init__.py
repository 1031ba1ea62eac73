"""What a process needs to take part in a lesson: ROS domain, environment, neighbours."""
