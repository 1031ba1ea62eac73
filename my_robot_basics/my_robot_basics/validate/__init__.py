"""Judge the exercises of a lesson: what the grader and *Validate* have in common.

- A notebook: `cells` says what each cell is for, `exercises` what to run of it, `names` which
  names a cell needs.
- What came of its cells: `messages` and `outputs` gather it, `timeouts` waits for it, `questions`
  are a check's to the student's kernel, `verdict` judges one check and `judging` an exercise.
- *Validate* itself: `lesson` reads a student's notebook, `rooms`, `kernel`, `forks` and
  `forkserver` start what its cells run in, `short_budget` says how long each may take,
  `checks_budget` how long its checks may, and `overdue` what was given up, `cell_names` names
  cells as students find them, `run` does all of it, `report` tells it, `check_feedback` of each
  cell, `as_text` in a terminal, and `server` with `labextension/` in JupyterLab.
- For all of them: `errors`, `limits`, `text`, `titles`, `together`.
"""
