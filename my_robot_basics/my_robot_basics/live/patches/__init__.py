"""What this process changes about rclpy of Jazzy, and about its waits."""
