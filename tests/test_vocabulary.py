"""Names in the code use one word for one thing: that of ROS, Jupyter or Linux."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ('my_robot_basics/my_robot_basics', 'grader', 'launcher', 'deploy')
INSTEAD = {
    'mend': 'fix',
    'mended': 'fixed',
    'hear': 'receive',
    'hears': 'receives',
    'heard': 'received',
    'unheard': 'without subscription',
    'ears': 'recorder',
    'patience': 'timeout',
    'begun': 'started',
    'crowd': 'busy',
    'crowded': 'busy, or stalled of processes',
    'warm': 'forked',
    'errand': 'connection',
    'inhabitants': 'pids',
}
"""Words that once were here, and what to write."""


def names_in(tree):
    """Yield each name that a module defines or uses."""
    for node in ast.walk(tree):
        for field in ('name', 'id', 'attr', 'arg'):
            if isinstance(name := getattr(node, field, None), str):
                yield name


def words_of(name):
    return [word.lower() for word in re.findall(r'[A-Z]?[a-z]+|[A-Z]+', name)]


def test_names_in_the_code_use_the_words_of_the_field():
    paths = [path for folder in FOLDERS for path in (ROOT / folder).rglob('*.py')]
    found = {
        (str(path.relative_to(ROOT)), name, INSTEAD[word])
        for path in paths
        for name in names_in(ast.parse(path.read_text(encoding='utf-8')))
        for word in words_of(name)
        if word in INSTEAD
    }
    assert len(paths) > 300
    assert sorted(found) == []
