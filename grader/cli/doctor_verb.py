"""The output of `./course doctor`: what isolates student code, and who can reach whose nodes."""

import argparse

from grader.cli.audiences import describe_audiences
from grader.course import Course
from grader.kernels.isolation import (
    missing_protection,
    protections,
    reason_not_forked,
    try_cgroups,
)


def run_doctor(course: Course, asked: argparse.Namespace) -> int:
    """Print what isolates student code on this machine. Return 1 if something is missing."""
    print('What isolates student code while it is graded:')
    counted = try_cgroups()
    isolating = protections()
    for protection in (*isolating, counted):
        lacks = 'without' if protection is counted else 'MISSING'
        print(f'  {lacks if protection.problem else "ok     "}  {protection.name}')
    print(*describe_audiences(isolating), sep='\n')
    if problem := missing_protection():
        print(f'\n{problem[0].upper()}{problem[1:]}.')
        return 1
    print('Nothing is missing: ./course grade runs each submission in a sandbox.')
    if counted.problem:
        print(
            f'Its limits are less strict than they could be: {counted.problem}. {counted.remedy}.'
        )
    if problem := reason_not_forked():
        print(f'It is slower than it could be: no kernel can be forked here, because {problem}.')
    return 0
