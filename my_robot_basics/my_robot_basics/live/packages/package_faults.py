"""What is wrong with a package, or with its build, in a sentence with a hint."""

import ast
import re
from pathlib import Path

from my_robot_basics.exchange.endings import signal_name
from my_robot_basics.session.package_files import PackageFiles

BUILD_TYPE = 'ament_python'
_LAST_LINE = re.compile(r'^(?:\w+\.)*(\w*(?:Error|Exception|Interrupt|Exit|Warning))(?:: (.*))?$')
_IN_FILE = re.compile(r'^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)')
_CANNOT_COPY = re.compile(r"error: can't copy '([^']+)'")
_SETUP_ERROR = re.compile(r'^error: (.+)$')
_REFUSED = re.compile(r"setup\(\)' was never called")
"""What is left of an error in the arguments of setup(): colcon discards its message."""
_COLCONS = ('CalledProcessError', 'DeprecationWarning', 'SetuptoolsDeprecationWarning')
"""Errors and warnings of colcon and setuptools themselves, beside the package's own error."""
_MOST = 300
NO_PYTHON = (ValueError, RecursionError, MemoryError)
"""What Python's parser raises besides SyntaxError: for null bytes, and for too deep nesting."""


def fault_in_sources(package: str, files: PackageFiles) -> str:
    """Return what is wrong with a package's sources; '' if no fault is found before the build."""
    if 'package.xml' not in files.taken:
        deeper = [name for name in files.taken if name.endswith('/package.xml')]
        if len(deeper) == 1:
            inner = short(f'{package}/{deeper[0].removesuffix("package.xml")}')
            return (
                f'package.xml is in {inner}, and has to be in {package}/: move all that is in '
                f'{inner} up into {package}/'
            )
        return (
            f'{package}/ has no package.xml, so it is no ROS package yet: write one, or begin '
            f'with `ros2 pkg create --build-type {BUILD_TYPE} {package}` in an empty folder'
        )
    if problem := _fault_in_manifest(package, files.taken['package.xml']):
        return problem
    if 'setup.py' not in files.taken:
        return (
            f'{package}/ has no setup.py, which tells colcon what to install: write one that '
            'calls setup() of setuptools'
        )
    try:
        ast.parse(files.taken['setup.py'].read_bytes())
    except SyntaxError as error:
        where = f'line {error.lineno} of {package}/setup.py'
        return f'{where} is not valid Python ({error.msg}): fix that line, and build again'
    except NO_PYTHON as error:
        return f'{package}/setup.py is not valid Python ({error}): write it again as text'
    return ''


def _fault_in_manifest(package: str, file: Path) -> str:
    from catkin_pkg.package import InvalidPackage, parse_package_string

    try:
        manifest = parse_package_string(file.read_text(encoding='utf-8'), filename='package.xml')
    except (InvalidPackage, UnicodeDecodeError, AssertionError) as error:
        said = ' '.join(str(error).split())
        return (
            f'{package}/package.xml is not valid ({short(said)}): fix that, and build again; '
            'colcon would pass over it'
        )
    if manifest.name != package:
        return (
            f'package.xml names the package {short(manifest.name)!r}, and its folder is '
            f'{package}/: write <name>{package}</name>'
        )
    if not any(export.tagname == 'build_type' for export in manifest.exports):
        return (
            f'package.xml has no build type: write <export><build_type>{BUILD_TYPE}</build_type>'
            '</export> into it, as its last part'
        )
    build_type = manifest.get_build_type()
    if build_type != BUILD_TYPE:
        return (
            f'package.xml has the build type {short(build_type)}, expected {BUILD_TYPE}: write '
            f'<export><build_type>{BUILD_TYPE}</build_type></export>'
        )
    return ''


def fault_in_words(package: str, status: int, words: str) -> str:
    """Return the error in the output of colcon, after it has failed, and what to do."""
    if status < 0:
        return (
            f'colcon was ended by {signal_name(-status)} while it built {package}: look for what '
            'setup.py starts or uses up'
        )
    lines = words.splitlines()
    if found := next((m for line in lines if (m := _CANNOT_COPY.search(line))), None):
        path = found[1]
        if path == f'resource/{package}':
            return (
                f'setup.py installs {path}, and there is no such file: make the folder resource/ '
                f'in {package}/, and an empty file {package} in it'
            )
        return f'setup.py installs {short(path)}, and there is no such file: correct data_files'
    if _REFUSED.search(words):
        return (
            f'colcon does not build {package}: setup.py calls no setup(), or setup() refuses a '
            f"value, such as an entry point that is not 'NAME = {package}.MODULE:main', or two "
            f'without a comma between them: run `python3 setup.py --name` in {package}/, which '
            'tells why'
        )
    return f'colcon does not build {package}: {_last_error(lines)}: fix that, and build again'


def _last_error(lines: list[str]) -> str:
    """Return the last error in the output, with the line of the package's file that caused it."""
    where = found = at_error = ''
    is_run = False
    for line in lines:
        if at := _IN_FILE.match(line):
            file, number = at['file'], at['line']
            if '/.packages/' in file:
                where = f'{file.split("/.packages/")[1]}, line {number}: '
            elif file == '<string>' and is_run:
                where = f'setup.py, line {number}: '
            is_run = is_run or line.endswith('in run_setup')  # where setuptools runs setup.py
        elif (error := _LAST_LINE.match(line.strip())) and error[1] not in _COLCONS:
            found, at_error = line.strip(), where
        elif error := _SETUP_ERROR.match(line.strip()):
            found, at_error = error[1], ''
    where = at_error
    if not found:
        said = [line.strip() for line in lines if line.strip() and not _is_colcons(line)]
        found = said[-1] if said else 'it says nothing of why'
    return where + short(found)


def _is_colcons(line: str) -> bool:
    return line.startswith(('Starting >>>', 'Finished <<<', 'Failed   <<<', 'Summary:', '---'))


def short(text: str) -> str:
    """Return an untrusted text as one printable line, shortened if it is long."""
    line = ' '.join(text.split())
    line = ''.join(character if character.isprintable() else '?' for character in line)
    return line if len(line) <= _MOST else line[: _MOST - 1] + '…'
