"""What is kept: nbgrader's database, submissions, due dates, late penalties, earlier results."""
