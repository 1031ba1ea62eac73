"""Say below a NameError which cell of the lesson has to run first.

After a restart of the kernel, students go on where they were: then a name that the lesson defines
further up is missing, and Python's message does not tell that. Imports nothing that is slow.
"""

from typing import Any

from my_robot_basics.session import cells_run, kernel


def watch() -> None:
    """From now on, look after each cell of a student's own notebook; again, it does nothing."""
    kernel.call_after_cells(_after_cell)


def number_of_cell(error: BaseException) -> int:
    """Return the number of the cell that has to run before the one that raised this; 0 if none."""
    name = error.name if isinstance(error, NameError) else ''
    return _cell_not_run(name) if name else 0


def _after_cell(result: Any) -> None:
    error = result.error_in_exec
    number = number_of_cell(error) if error is not None else 0
    if number:
        from my_robot_basics.session.errors import tell

        tell(
            f'`{error.name}` comes from cell {number} of this lesson, which has not run to its '
            'end since the kernel started: run that cell first, or choose Run → Run All Above '
            'Selected Cell; then run this one again',
            in_one=False,
        )


def _cell_not_run(name: str) -> int:
    """Return the number of the last cell above this one that defines a name and has not ended.

    0 if there is none. A cell that an exception stopped has not. Cells are counted as in
    JupyterLab's status bar: from 1, texts too.
    """
    from my_robot_basics.validate.lessons.names import names_of

    found = 0
    for number, cell in enumerate(cells_run.lesson().get('cells', ()), start=1):
        if cell.get('id') == cells_run.current():
            return found
        if (
            cell.get('cell_type') == 'code'
            and not _has_run_to_its_end(cell.get('id', ''))
            and name in names_of(''.join(cell.get('source', ''))).bound
        ):
            found = number
    return 0


def _has_run_to_its_end(cell_id: str) -> bool:
    return bool(cells_run.text_of(cell_id)) and not cells_run.error_of(cell_id)
