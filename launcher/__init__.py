"""What `./course` does once it has found a Python: set up `.venv`, then run a verb.

It runs before anything is installed, so it imports the standard library alone. Students have it
in their bundle, too. `verbs.txt` is the table of the verbs.
"""
