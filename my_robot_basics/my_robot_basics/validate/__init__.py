"""Judge the exercises of a lesson: what the grader and *Validate* have in common.

- A notebook: `cells` says what each cell is for, `exercises` what to run of it, `names` which
  names a cell needs.
- Running its cells: `messages` and `outputs` collect their outputs, `timeouts` waits for their
  end, `questions` has a check's requests to the student's kernel, `verdict` judges one check and
  `judging` an exercise.
- *Validate* itself: `lesson` reads a student's notebook, `rooms`, `kernel`, `forks` and
  `forkserver` start its kernels, `short_budget` limits the time of each cell, `checks_budget`
  that of the checks, `overdue` reports what was given up, `cell_names` names cells as students
  find them, `run` does all of it, `report` is the result, with `check_feedback` of each cell,
  `as_text` prints it, and `server` with `labextension/` shows it in JupyterLab.
- Used by all of them: `errors`, `limits`, `text`, `titles`, `together`.
"""
