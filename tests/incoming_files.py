"""Files that come in at paths, and the owners that are found for them."""

from datetime import UTC, datetime

from grader.collect.incoming import Incoming
from grader.collect.matching import match

ASSIGNMENTS = ['00_two_link_arm', '02_joint_state', '03_publisher']
LATER = datetime(2026, 1, 1, 12, tzinfo=UTC)
MALLORY = 'Mallory Evil_666_assignsubmission_file_'
ADA = 'Ada Lovelace_1815_assignsubmission_file_'
BLACKBOARD = 'Lab 2_{}_attempt_2026-01-{}-03-04-05_02_joint_state.ipynb'


def arriving(folder):
    """Return a function that makes a collected file for a path.

    A folder in the path that ends in .zip is a student's archive.
    """

    def incoming(path, content='', *, modified=LATER, problem=''):
        parts = tuple(path.split('/'))
        file = folder / f'{len(list(folder.iterdir()))}'
        file.write_text(content or path)
        archives = [i for i, part in enumerate(parts[:-1], 1) if part.endswith('.zip')]
        return Incoming(parts, file, modified, problem, archives[0] if archives else 0)

    return incoming


def owners(*found, **options):
    hand_ins, left = match(found, ASSIGNMENTS, **options)
    return [(each.student_id, each.assignment) for each in hand_ins], [
        (each.incoming.path, each.reason) for each in left
    ]


def time_of(*found, **options):
    (hand_in,), left = match(found, ASSIGNMENTS, **options)
    when = hand_in.handed_in
    return when and when.strftime('%m-%d %H:%M:%S'), [each.reason for each in left]
