"""What an answer returns or logs: angles, positions, definitions, predictions."""
