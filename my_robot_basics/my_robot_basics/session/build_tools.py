"""The programs that a machine needs, besides .venv, to compile a package of interfaces."""

import os
import shutil
import sys
import sysconfig
from pathlib import Path


def missing_programs() -> dict[str, str]:
    """Return each missing program, and the Debian or Ubuntu package that contains it."""
    header = Path(sysconfig.get_path('include'), 'Python.h')
    python = 'python{}.{}-dev'.format(*sys.version_info)
    wanted = {
        'gcc': (_has_program('CC', 'cc', 'gcc', 'clang'), 'build-essential'),
        'g++': (_has_program('CXX', 'c++', 'g++', 'clang++'), 'build-essential'),
        'make': (_has_program('', 'make', 'gmake'), 'build-essential'),
        'cmake': (_has_program('CMAKE_COMMAND', 'cmake'), 'cmake'),
        f'Python.h of Python {python[6:-4]}': (header.is_file(), python),
    }
    return {name: package for name, (is_here, package) in wanted.items() if not is_here}


def build_problem(package: str) -> str:
    """Say why a package of interfaces cannot be compiled here; '' if it can."""
    lacking = missing_programs()
    if not lacking:
        return ''
    *most, last = lacking
    names = f'{", ".join(most)} and {last} are' if most else f'{last} is'
    why = (
        f'{package} cannot be built on this machine: {names} missing; to get what is missing on '
        f'Debian and Ubuntu: sudo apt install {" ".join(dict.fromkeys(lacking.values()))}'
    )
    if Path(sys.prefix, 'share', package, 'package.xml').is_file():
        return f'{why}; until then, the {package} that the course has installed goes on working'
    return why


def _has_program(variable: str, *programs: str) -> bool:
    """Whether the program that an environment variable names, or else one of these, exists."""
    named = os.environ.get(variable, '').split()[:1]
    return any(map(shutil.which, named or programs))
