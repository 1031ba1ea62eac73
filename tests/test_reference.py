"""The reference for instructors: everything public is documented, and the pages can be built."""

import inspect
import subprocess
import sys

import pytest

from grader.course import ROOT
from my_robot_basics import checks, live

PUBLIC = [(page, name) for page in (checks, live) for name in page.__all__]


def is_documented(thing):
    return bool((inspect.getdoc(thing) or '').strip())


def documented(thing):
    """Return the members of a class or module that the reference documents, with their names."""
    names = getattr(thing, '__all__', [name for name in vars(thing) if name[:1] != '_'])
    own = [(name, inspect.getattr_static(thing, name)) for name in names]
    if inspect.isclass(thing):
        return [(n, m) for n, m in own if inspect.isfunction(m) or isinstance(m, property)]
    return [(n, m) for n, m in own if inspect.isfunction(m) and m.__module__ == thing.__name__]


@pytest.mark.parametrize(
    ('page', 'name'), PUBLIC, ids=lambda value: getattr(value, '__name__', value)
)
def test_everything_public_has_a_docstring_and_types(page, name):
    thing = getattr(page, name)
    assert is_documented(thing)
    inner = documented(thing) if inspect.isclass(thing) or inspect.ismodule(thing) else []
    assert [n for n, member in inner if not is_documented(member)] == []
    functions = [thing, *(member for _, member in inner)]
    untyped = [
        f'{function.__qualname__}: {parameter}'
        for function in functions
        if inspect.isfunction(function)
        for parameter in inspect.signature(function).parameters.values()
        if parameter.name != 'self' and parameter.annotation is parameter.empty
    ]
    assert untyped == []


@pytest.mark.slow
@pytest.mark.starts
def test_the_reference_pages_can_be_built(tmp_path):
    command = [sys.executable, '-P', str(ROOT / 'docs/build_reference.py'), str(tmp_path)]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert (run.returncode, run.stderr) == (0, '')
    for page in checks, live:
        text = (tmp_path / f'{page.__name__.replace(".", "/")}.html').read_text(encoding='utf-8')
        names = [n for n in page.__all__ if not inspect.ismodule(getattr(page, n))]
        assert [name for name in names if f'id="{name}"' not in text] == []
        assert page is live or 'id="RecordedMessages.rate_hz"' in text
    joints = (tmp_path / 'my_robot_basics/checks/values/joints.html').read_text(encoding='utf-8')
    assert 'id="agree"' in joints
    student = (tmp_path / 'my_robot_basics/exchange/student.html').read_text(encoding='utf-8')
    assert 'id="call"' in student
    assert 'id="set_use_sim_time"' not in student
    assert not (tmp_path / 'my_robot_basics/exchange/wire.html').exists()
