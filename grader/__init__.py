"""Grades the course: a submission is collected, restored, run in a sandbox, judged and stored.

`grade` is the whole flow, `grading` that of one submission, `replay` grades once more and stores
nothing, and `course` says where a course keeps its files. Each package imports only from those
named before it in LAYERS:

- `cli`: The command line: `./course VERB`, its arguments and what each verb does.
- `authoring`: From the instructors' source to what students get: release, contents page, bundle.
- `collect`: Take in what students handed in, from archives and folders of any course platform.
- `notebook`: A submitted notebook: read it, and put it back into the shape of its source.
- `judging`: Run the exercises of one submission and give each grade cell its verdict.
- `sandbox`: What student code can reach and use up: files, system calls, network, memory,
  processes.
- `kernels`: Jupyter kernels inside of sandboxes: started or forked, spoken to, and how each one
  ended.
- `workers`: Processes that grade, on this machine or on a Dask cluster, and how many at a time.
- `autograde`: What `nbgrader autograde` calls of this package, instead of its own preprocessors.
- `storage`: What is kept: nbgrader's database, submissions, due dates, late penalties, earlier
  results.
- `export`: What leaves the gradebook as files: scores, totals, sample solutions.
- `report`: What people read: feedback for students; progress, run report and formgrader for
  instructors.
- `passback`: Scores and feedback in the forms that course platforms import.
- `serving`: The resident process that grades each submission as it arrives, and releases feedback.
- `common`: What every part uses: errors, files, text, names of students, dates, a process that
  parses.
"""

LAYERS = (
    'common',
    'notebook',
    'course',
    'authoring',
    'sandbox',
    'storage',
    'kernels',
    'judging',
    'export',
    'workers',
    'autograde',
    'collect',
    'grading',
    'grade',
    'replay',
    'report',
    'passback',
    'serving',
    'cli',
    '__main__',
)
"""Packages, and modules beside them, from the lowest to the highest."""
