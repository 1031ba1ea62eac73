"""Judge the exercises of a lesson: what the grader and *Validate* have in common.

- A notebook: `cells` says what each cell is for, `exercises` what to run of it, `names` which
  names a cell needs.
- What came of its cells: `messages` and `outputs` gather it, `patience` waits for it, `verdict`
  judges it.
- For all of them: `errors`, `limits`, `text`.
"""
