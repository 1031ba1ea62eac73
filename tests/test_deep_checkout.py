"""The whole course deep below a home that nobody else may enter: it is graded there, too."""

import os
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import pytest

from grader.course import ROOT

pytestmark = pytest.mark.isolation

ORDINARY = 65_534
SAMPLE = '02_joint_state-pass-numpy'
GRADE = f"""
import sys, tempfile
from pathlib import Path
import nbformat
from grader.course import ROOT, Course
from grader.judging.execute import execute
from grader.storage.registering import (register)
from grader.notebook.restore import restore
from grader.storage.pipeline import prepare
if __name__ == '__main__':
    course = Course(gradebook=Path(tempfile.mkdtemp()))
    register(course, '02_joint_state')
    (path,) = ROOT.glob('tests/submissions/**/{SAMPLE}.ipynb')
    submitted = nbformat.read(path, as_version=4)
    restored = restore(submitted, course.template('02_joint_state')).notebook
    graded = execute(prepare(course, '02_joint_state', restored))
    assert not [note for verdict in graded.verdicts for note in verdict.notes]
    print(ROOT, sys.prefix, *[verdict.outcome for verdict in graded.verdicts], sep='\\n')
"""


def moved(home: Path, deep: Path) -> list[str]:
    """Return the beginning of a command that finds the course at `deep` and nowhere else."""
    deep.mkdir(parents=True)
    options = ['--ro-bind', str(ROOT), str(deep)]
    packages = Path(sysconfig.get_path('purelib')).relative_to(ROOT)
    # files in which an installation writes the path of its folder
    for path in (*(ROOT / packages).glob('__editable__*.pth'), Path(sys.prefix, 'bin/alembic')):
        own = home / path.name
        own.write_text(path.read_text().replace(str(ROOT), str(deep)))
        own.chmod(0o755)
        options += ['--ro-bind', str(own), str(deep / path.relative_to(ROOT))]
    return ['bwrap', '--dev-bind', '/', '/', *options, '--tmpfs', str(ROOT)]


@pytest.fixture
def home():
    """A home folder that only its owner may enter, below a folder that everybody may enter."""
    with tempfile.TemporaryDirectory(prefix='home-', ignore_cleanup_errors=True) as folder:
        yield Path(folder)


@pytest.mark.slow
@pytest.mark.parametrize(
    'user',
    [
        pytest.param(0, id='as root', marks=pytest.mark.slow),
        pytest.param(ORDINARY, id='as an ordinary user'),
    ],
)
def test_a_checkout_deep_below_a_closed_home_is_graded(home, user):
    if os.geteuid() != 0 and user == 0:
        pytest.skip('we are no root')
    if not Path(sys.prefix).is_relative_to(ROOT):
        pytest.skip('the environment lies elsewhere')
    deep = home / 'a_student_of_robotics' / ('d' * 40) / ('e' * 40) / 'my_robot_basics'
    python = deep / Path(sys.executable).relative_to(ROOT)
    assert len(str(deep)) > 120
    command = moved(home, deep)
    if os.geteuid() == 0 and user:
        for path in (home, *home.rglob('*')):
            os.chown(path, user, user)
        # the base Python may lie in root's own home
        base = sys.base_prefix
        top = f'/{Path(base).parts[1]}'
        command += ['--tmpfs', top, '--dir', base, '--ro-bind', base, base]
        command += ['--cap-add', 'CAP_SETUID', '--cap-add', 'CAP_SETGID', '--', 'setpriv']
        command += [f'--reuid={user}', f'--regid={user}', '--clear-groups']
    done = subprocess.run(
        [*command, '--', str(python), '-P', '-c', GRADE],
        env={
            'PATH': os.pathsep.join([str(python.parent), os.environ['PATH']]),
            'HOME': str(home),
            'PYTHONDONTWRITEBYTECODE': '1',
        },
        capture_output=True,
        text=True,
        cwd='/',
    )
    root, prefix, *outcomes = done.stdout.splitlines() or [done.stderr, '']
    assert (root, prefix) == (str(deep), str(deep / '.venv'))
    assert outcomes == ['passed'] * 3
