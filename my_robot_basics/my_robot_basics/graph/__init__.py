"""The ROS graph, from a node of its own: who is there, and whose QoS is compatible."""
