"""Judge the exercises of a lesson: what the grader and *Validate* have in common.

The code is in packages and a few modules; each imports only from those before it in LAYERS:

- `errors`: Errors that are not a verdict about an answer.
- `text`: What students wrote, made safe to print and to show.
- `together`: Runs several awaitables concurrently.
- `lessons`: A notebook: the role of each cell, its exercises, and the names that a cell needs.
- `kernels`: Kernels on the student's machine, and what a cell prints, in bounds and in time.
- `verdicts`: Judges a check and a whole exercise, in rooms that the caller opens.
- `reports`: The results for each exercise and check, and how they read.
- `progress`: Which exercises have passed, remembered on the student's own machine.
- `running`: *Validate* itself: opens rooms, judges a lesson in them, returns its report.
- `served`: Files that a Jupyter server serves.
- `harmless_addresses`: Addresses of a Jupyter server, which run nothing that others chose.
- `server`: Shows *Validate*, and a student's progress, in JupyterLab, with `labextension/`.
- `__main__`: `./course validate`.
"""

LAYERS = (
    'errors',
    'text',
    'together',
    'lessons',
    'kernels',
    'verdicts',
    'reports',
    'progress',
    'running',
    'served',
    'harmless_addresses',
    'server',
    '__main__',
)
"""The parts, lowest layer first."""
