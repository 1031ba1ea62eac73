"""What crosses between a notebook's kernel and a check's: a probe, questions and replies."""
