"""The image and the development container name what exists: verbs, pins, ports, files, stages."""

import configparser
import json
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from grader.authoring.bundle import AS_THEY_ARE, FOLDER
from launcher.offline import PYTHONS
from launcher.verbs import read_verbs

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / 'Containerfile').read_text()
DEVCONTAINER = json.loads((ROOT / '.devcontainer/devcontainer.json').read_text())
DOCUMENT = (ROOT / 'docs/where-it-runs.md').read_text()
PYTHON_OF_DEBIAN = {'12': '3.11', '13': '3.13'}


def instructions(text=TEXT):
    """Return (instruction, the rest of its line) for each, with continued lines joined."""
    lines = [line for line in text.splitlines() if line and not line.startswith('#')]
    joined = '\n'.join(lines).replace('\\\n', '')
    return [tuple(line.split(maxsplit=1)) for line in joined.splitlines()]


def of(kind):
    return [rest for instruction, rest in instructions() if instruction == kind]


def commands():
    """Return each ./course command line that is in the two files."""
    run = [part.strip() for line in of('RUN') for part in line.split('&&')]
    written = [*run, shlex.join(json.loads(of('CMD')[0]))]
    written += [each for key, each in DEVCONTAINER.items() if key.endswith('Command')]
    return [shlex.split(each) for each in written if each.startswith('./course')]


def test_each_command_is_a_verb_that_students_have():
    verbs = read_verbs()
    named = [command[1] for command in commands()]
    assert named == ['progress', 'lab', 'progress', 'lab']
    assert {verbs[name].owner for name in named} == {'everyone'}


def test_each_container_starts_jupyterlab_without_a_browser_on_the_open_port():
    ports = {
        option.removeprefix('--port=')
        for command in commands()
        for option in command
        if option.startswith('--port=')
    }
    labs = [command for command in commands() if command[1] == 'lab']
    assert all('--no-browser' in command for command in labs)
    assert ports == {*of('EXPOSE')} == {'8888'}
    assert DEVCONTAINER['forwardPorts'] == [8888]
    assert set(DEVCONTAINER['portsAttributes']) == ports
    assert re.findall(r'-p 127\.0\.0\.1:(\d+):(\d+)', DOCUMENT) == [('8888', '8888')]
    assert '--ip=0.0.0.0' in labs[0]  # else nobody outside of the container reaches it


def test_the_python_of_the_image_is_one_that_the_pins_are_for():
    ((release,),) = [re.findall(r'^debian:(\d+)-slim AS system$', line) for line in of('FROM')[:1]]
    assert PYTHON_OF_DEBIAN[release] in PYTHONS
    assert 'python3-venv' in of('RUN')[0].split()


def test_the_image_installs_packages_only_by_the_pinned_environment_file():
    """No command names a Python package: environment.txt does, with its hashes."""
    assert {'course', 'environment.txt'} < set(AS_THEY_ARE)
    assert not re.search(r'\b(pip|uv)\b', TEXT)
    assert f'-f Containerfile {FOLDER}' in DOCUMENT


def test_the_container_runs_as_student_and_copies_only_the_course():
    assert of('USER') == ['student'] == [DEVCONTAINER['remoteUser']]
    order = [kind for kind, _ in instructions()]
    assert order.index('USER') < order.index('COPY') < order.index('CMD')
    assert 'ADD' not in order
    assert of('COPY') == ['--chown=student:student . /course']


def test_the_development_container_builds_an_existing_stage():
    build = DEVCONTAINER['build']
    assert (ROOT / '.devcontainer' / build['dockerfile']).resolve() == ROOT / 'Containerfile'
    stages = re.findall(r'^FROM \S+ AS (\w+)$', TEXT, re.MULTILINE)
    assert stages == ['system', 'lessons']
    assert build['target'] in stages


@pytest.mark.parametrize('option', ['seccomp', 'systempaths', 'apparmor'])
def test_the_document_names_each_security_option_once_and_no_wider_one(option):
    (line,) = re.findall(r'^docker run .*?…$', DOCUMENT, re.MULTILINE | re.DOTALL)
    assert line.count(f'--security-opt {option}=') == 1
    assert '--privileged' not in line
    assert 'seccomp=unconfined' not in line


def test_the_service_file_agrees_with_the_recipe_and_delegates_cgroups():
    """Its folders are those of the recipe and of the hub's exchange."""
    unit = configparser.ConfigParser()
    unit.optionxform = str
    unit.read_string((ROOT / 'docs/serve.service').read_text())
    service = unit['Service']
    program, verb, inbound = service['ExecStart'].split()
    assert verb in read_verbs()
    assert program == f'{service["WorkingDirectory"]}/course'
    assert f'git clone ADDRESS {service["WorkingDirectory"]} ' in DOCUMENT
    assert f'useradd --create-home --shell /bin/bash {service["User"]}\n' in DOCUMENT
    hub = tomllib.loads((ROOT / 'deploy/jupyterhub/class.toml').read_text())
    assert inbound == f'{hub["exchange"]}/{hub["course"]}/inbound'
    assert (service['Delegate'], service['Restart']) == ('yes', 'on-failure')
