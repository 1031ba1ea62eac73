"""Why is nothing arriving? Looks at the running graph and names faults, each with its fix.

`looking` gathers the evidence, `rules` (one a file, one table) judge it, `report` and `picture`
tell. `live.why` and the console script `topic_doctor` are the two ways in.
"""
