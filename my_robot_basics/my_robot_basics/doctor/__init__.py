"""Why is nothing arriving? Looks at the running graph and names faults, each with its fix.

`looking` gathers the evidence on a topic, `service_looking` that on a service, `action_looking`
that on an action; `rules`, `service_rules` and `action_rules` (one a file, a table each) judge
it, `report` and `picture` tell. `live.why` and the console script `topic_doctor` are the two ways
in, both through `diagnosing`.
"""
