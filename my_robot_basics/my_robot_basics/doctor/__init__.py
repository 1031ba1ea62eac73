"""Why does no message arrive? Observes the running graph and names faults, each with its fix.

`looking` collects the evidence on a topic, `service_looking` that on a service, `action_looking`
that on an action. `rules`, `service_rules` and `action_rules` judge it: each rule is a function,
and a row of the table `RULES`. `report` and `picture` show the result. `live.why` and the console
script `topic_doctor` are the entry points; both call `diagnosing`.
"""
