"""What leaves the gradebook as files: scores, totals, sample solutions."""
