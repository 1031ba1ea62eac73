"""What people read: feedback for students; progress, run report and formgrader for instructors."""
