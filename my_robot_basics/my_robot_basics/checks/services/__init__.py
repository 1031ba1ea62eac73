"""Services: the check's client of the student's server, and its server for a client."""
