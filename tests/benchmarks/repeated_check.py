"""Print how often a right answer passes a grade cell that runs again and again in one kernel.

.venv/bin/python tests/benchmarks/repeated_check.py [--busy N] [TIMES] [LESSON] [GRADE_ID]

The node of the answer is not started again, so that it answers ever more requests of checks.
"""

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from answered import read
from live_lesson import Lesson
from validate_time import busy_loops

LONGEST_SEC = 600.0


def main() -> None:
    """Run the cells up to the grade cell without demonstrations, then that cell repeatedly."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('times', nargs='?', type=int, default=24)
    parser.add_argument('lesson', nargs='?', default='11_parameters')
    parser.add_argument('grade_id', nargs='?', default='adjustable_rate_refuses')
    parser.add_argument('--busy', type=int, default=0, help='busy loops beside it')
    options = parser.parse_args()
    before, check = cells_of(options.lesson, options.grade_id)
    passed, lesson = 0, Lesson(*before)
    with busy_loops(options.busy):
        for number in range(1, options.times + 1):
            began = time.monotonic()
            cell = lesson.send(check)
            lesson.wait_for(lambda cell=cell: cell.done, timeout_sec=LONGEST_SEC)
            passed += cell.error is None
            why = ' '.join(cell.error.split()) if cell.error else 'passes'
            print(f'{number:4} {time.monotonic() - began:6.1f} s  {why}', flush=True)
    print(f'{passed} of {options.times} pass')
    lesson.shut_down()


def cells_of(lesson: str, grade_id: str) -> tuple[list[str], str]:
    """Return the sources of the cells that the grade cell needs, and its own."""
    before: list[str] = []
    for cell in read('solutions', lesson).cells:
        grading = cell.metadata.get('nbgrader', {})
        if grading.get('grade_id') == grade_id:
            return before, cell.source
        is_demo = 'demo' in cell.metadata.get('tags', [])
        if cell.cell_type == 'code' and not is_demo and not grading.get('grade'):
            before.append(cell.source)
    raise SystemExit(f'{lesson} has no grade cell {grade_id}')


if __name__ == '__main__':
    main()
