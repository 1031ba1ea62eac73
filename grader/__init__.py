"""Grades the course: a submission comes in, is healed, runs in rooms, is judged, stored and told.

Its modules, in the order in which things happen:

- What is asked for: `__main__`, `arguments`, `verbs`, `stopping`, `demo`.
- Lessons go out: `release`, `marks`, `replaced`, `leaks`, `index`, `bundle`.
- Submissions come in: `collect`, `intake`, `owners`, `naming`, `forms`, `students`, `incoming`,
  `archives`, `entries`, `dates`, `platforms`.
- A run, from what was handed in to what is stored: `submitted`, `grade`, `reuse`, `replay`. The
  work is a `task`, what comes of it is checked by `results`, and a `crew` does it: `workers` with
  `worker`, so many at a time as `pressure` says; or `cluster`, `connection` and `remote`.
- One submission: `submission`, `reading`, `raw_notebook`, `heal`, `pipeline`, `passes`,
  `nbgrader_input`. One exercise of it: `execute` and `local_paths`, with the exercises, plans and
  verdicts of my_robot_basics.validate, which students have, too.
- Where a student's code runs: `isolation` says whether it can be kept in. `rooms`, `sandbox`,
  `bubblewrap`, `sights`, `seccomp`, `system_calls`, `limits`, `hierarchies`, `cgroups`, `memory`,
  `memory_watch`, `places` and `leftovers` keep it in.
  `provisioner`, `warm`, `servers`, `forked`, `waiting` and the program `forkserver` begin a kernel
  there; `kernels` and `pool` run its cells; `notifying`, `signals` and `endings` say
  why it ended.
- What is kept: `gradebook`, `saving`, `lateness`, `due`, `turn`, `database`, `backups`, `records`.
- What is told: `feedback` and `page` to students; `table`, `report`, `tally`, `reasons`, `charts`,
  `scores`, `totals` and `formgrader` to teachers; `templates` for both. After the deadline:
  `sample_solutions`.
- For all of them: `course`, `errors`, `files`, `logs`, `parsing`, `text`, `versions`.
"""
