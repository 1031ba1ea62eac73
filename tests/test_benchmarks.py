"""No ordinary run measures anything, but each benchmark starts, with the arguments in the docs."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.starts

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / 'tests/benchmarks'
BENCHMARKS = {path.stem: path.read_text() for path in sorted(FOLDER.glob('*.py'))}
START = """
import argparse, json, runpy, sys

class Parsed(Exception):
    pass

def parse(parser, parse=argparse.ArgumentParser.parse_args):
    parse(parser)
    raise Parsed

argparse.ArgumentParser.parse_args = parse
for path, arguments in json.load(sys.stdin):
    print(path, *(arguments or []), flush=True)
    sys.argv = [path, *(arguments or [])]
    try:
        runpy.run_path(path, run_name='imported' if arguments is None else '__main__')
    except Parsed:
        continue
    assert arguments is None, 'it did not parse its arguments'
"""
"""Imports each benchmark, or runs it until it has parsed its arguments."""


SAMPLE = {'N': '1', 'RUNS': '1', 'TIMES': '1', 'ATTACK': 'crashes'}
"""Values for the words in capitals that a document gives a benchmark."""


def documented():
    """Yield each benchmark that a document or its own docstring calls, with its arguments."""
    for name, text in BENCHMARKS.items():
        for arguments in re.findall(rf'^    .*/{name}\.py(.*)', text, re.MULTILINE):
            yield name, re.sub(r'[][]|\.\.\.', '', arguments)
    for path in (ROOT / 'README.md', ROOT / 'SECURITY.md', *(ROOT / 'docs').glob('*.md')):
        text = path.read_text().replace('` with `', ' ')
        for script, arguments in re.findall(r'`(?:[^`]*[/ ])?(\w+)\.py\b([^`]*)`', text):
            if script in BENCHMARKS:
                yield script, arguments
        if path.stem == 'capacity':  # a column of one table has options alone
            for options in re.findall(r'\| `(--[^`]+)`.* \|$', text, re.MULTILINE):
                yield 'class_of_500', options


def start(*calls):
    """Start benchmarks in one child process, each as if it ran alone; return how that ended."""
    return subprocess.run(
        [sys.executable, '-P', '-c', START],
        input=json.dumps([(str(FOLDER / f'{name}.py'), given) for name, given in calls]),
        env=os.environ | {'PYTHONPATH': f'{FOLDER}:{ROOT / "tests"}:{ROOT}'},
        capture_output=True,
        text=True,
    )


def test_each_benchmark_can_be_imported():
    done = start(*((name, None) for name in BENCHMARKS))
    assert done.returncode == 0, done.stdout + done.stderr


def test_each_documented_command_is_one_that_its_benchmark_takes():
    calls = [
        (name, [SAMPLE.get(word, word) for word in shlex.split(given)])
        for name, given in documented()
        if 'argparse' in BENCHMARKS[name]
    ]
    assert len(calls) > 40
    done = start(*calls)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize('given', [['--beside', '0', '04_subscriber'], ['--rounds', 'many']])
def test_a_wrong_command_is_noticed(given):
    done = start(('latency', given))
    assert done.returncode == 2
    assert 'latency.py: error' in done.stderr
