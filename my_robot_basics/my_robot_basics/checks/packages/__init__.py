"""A package of the student's, built and run, and what `arm_player` has to do."""
