"""The ROS graph as a node of the check sees it: nodes, endpoints, and compatible QoS."""
