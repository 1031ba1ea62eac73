"""What the server and the client of `/move_arm` have to do."""
