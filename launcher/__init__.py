"""What `./course` does after it has found a Python: set up `.venv`, then run a verb.

It runs before anything is installed, so it imports only the standard library. The students'
bundle contains it, too. `verbs.txt` is the table of the verbs.
"""
