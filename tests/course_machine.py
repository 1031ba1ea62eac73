"""A machine with a small course, on which tests call `./course`."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
TOOLS = ['sh', 'cat', 'chmod', 'cp', 'dirname', 'env', 'mkdir', 'readlink', 'sleep', 'uname']
PYTHON = (
    f"""\
case $* in '-IS '*/launcher/__main__.py' '*) exec {shlex.quote(sys._base_executable)} "$@" ;; esac
"""
    """\
echo "python $*" >>"$CALLS"
case $* in
    *CS_GNU_LIBC*) echo '3.12.1 ' ;;
    -ISc*) echo 3.12.1 ;;
    *ensurepip*) ;;
    '-m venv'*) mkdir -p "$4/bin" && cp "$0" "$4/bin/python" ;;
    *'-m pip'*) ;;
    *) pwd >>"$CALLS"; [ -z "${PRINT_ENVIRONMENT:-}" ] || env ;;
esac
"""
)
"""A fake Python: it runs the launcher, and only records every other call."""
UV = """\
echo "uv $*" >>"$CALLS"
case $1 in venv) mkdir -p "$4/bin" && cp "$(command -v python3)" "$4/bin/python" ;; esac
"""


class Machine:
    """A small course in a folder with a space in its name, and the only programs on its PATH."""

    def __init__(self, folder):
        self.root = folder / 'my course'
        self.programs = folder / 'programs'
        self.calls_file = folder / 'calls'
        self.programs.mkdir()
        for tool in TOOLS:
            (self.programs / tool).symlink_to(shutil.which(tool))
        package = self.root / 'my_robot_basics/my_robot_basics'
        package.mkdir(parents=True)
        (package / '__init__.py').touch()
        (self.root / 'grader').mkdir()
        (self.root / 'grader/__init__.py').touch()
        shutil.copytree(
            ROOT / 'grader/kernels/kernelspec', self.root / 'grader/kernels/kernelspec'
        )
        button = 'my_robot_basics/my_robot_basics/validate/labextension'
        shutil.copytree(ROOT / button, self.root / button)
        unmade = shutil.ignore_patterns('__pycache__')
        shutil.copytree(ROOT / 'launcher', self.root / 'launcher', ignore=unmade)
        (self.root / 'notebooks').mkdir()
        for name in ('package.xml', 'setup.py', 'setup.cfg'):
            shutil.copy(ROOT / 'my_robot_basics' / name, package.parent)
        shutil.copytree(ROOT / 'arm_interfaces', self.root / 'arm_interfaces')
        for name in ('course', 'pyproject.toml', 'LICENSE', 'README.md'):
            shutil.copy(ROOT / name, self.root)
        (package.parent / 'resource').mkdir()
        (package.parent / 'resource/my_robot_basics').touch()
        pins = re.split(r'^(?=\w)', (ROOT / 'environment.txt').read_text(), flags=re.MULTILINE)
        # empy exists only as a source archive
        needed = [pin for pin in pins if pin.startswith(('pip==', 'setuptools==', 'empy=='))]
        (self.root / 'environment.txt').write_text(''.join(needed))

    def program(self, name, script):
        """Put a program on the PATH, or replace it."""
        path = self.programs / name
        path.unlink(missing_ok=True)
        path.write_text(f'#!/bin/sh\n{script}\n')
        path.chmod(0o755)

    def course(self, *arguments, before=(), script=None, **environment):
        self.calls_file.write_text('')
        others = ('PYTHON', 'MY_ROBOT_BASICS_WORKSPACE')
        clean = {k: v for k, v in os.environ.items() if k not in others}
        return subprocess.run(
            [*before, script or self.root / 'course', *arguments],
            cwd='/',
            env=clean
            | {'PATH': str(self.programs), 'CALLS': str(self.calls_file)}
            | {k: str(v) for k, v in environment.items()},
            capture_output=True,
            text=True,
            timeout=240,
        )

    def calls(self, beginning=''):
        lines = self.calls_file.read_text().splitlines()
        return [line for line in lines if line.startswith(beginning)]


def the_one_sentence(run):
    """Return the last line of stderr; check that only progress messages precede it."""
    lines = run.stderr.splitlines()
    assert run.returncode == 1, run
    assert all(line.startswith(('course: setting up', '  ')) for line in lines[:-1]), run.stderr
    assert lines[-1].startswith('course: ')
    assert lines[-1].endswith('.')
    return lines[-1].removeprefix('course: ')


def with_programs(bare):
    """Give a machine a fake Python and a fake uv, which only record their calls."""
    bare.program('python3', PYTHON)
    bare.program('uv', UV)
    return bare
