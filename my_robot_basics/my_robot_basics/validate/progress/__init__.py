"""Which exercises have passed, remembered on the student's own machine."""
