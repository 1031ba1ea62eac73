"""Pictures of the arm, of the graph, and of what happens to messages."""
