"""*Validate* itself: opens rooms, judges a lesson in them, returns its report."""
