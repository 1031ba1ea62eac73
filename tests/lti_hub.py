"""The hub of deploy/jupyterhub/ with LTI, to which a learning platform sends users.

It starts no servers. Its users exist on every Linux, so root is not needed.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import tomlkit
from hub_machine import DEPLOY, PATH, HubMachine, outside, running, write_settings

STUDENT, INSTRUCTOR, OUTSIDER = 'daemon', 'bin', 'sys'


@contextmanager
def lti_hub(platform):
    """Install and run a hub that trusts the platform, and tell the platform its address."""
    with tempfile.TemporaryDirectory(dir='/tmp', prefix='hub-') as name:  # short: has sockets
        machine = HubMachine(Path(name), INSTRUCTOR, (STUDENT,))
        write_settings(machine, STUDENT)
        settings = tomlkit.parse((machine.folder / 'class.toml').read_text())
        settings['lti'] = platform.settings()
        (machine.folder / 'class.toml').write_text(tomlkit.dumps(settings))
        platform.tool = machine.address
        install(machine.folder)
        with running(machine):
            yield machine


def install(folder):
    """Do what deploy/jupyterhub/install does for the hub only, without root."""
    for file in (*DEPLOY.glob('*.py'), *DEPLOY.glob('*.cjs'), *DEPLOY.glob('package*.json')):
        shutil.copy(file, folder)
    (folder / 'state').mkdir()
    uv = Path(sys.executable).with_name('uv')
    run([uv, 'venv', '--quiet', '--python', sys._base_executable, 'venv'], folder)
    pip = [uv, 'pip', 'install', '--quiet', '--python', 'venv/bin/python']
    run([*pip, '--require-hashes', '-r', DEPLOY / 'hub.txt'], folder)
    run(['npm', 'ci', '--loglevel=error', '--no-audit', '--no-fund'], folder)


def run(command, folder):
    """Run one step of the installation, with the hub's own Node.js."""
    environment = outside() | {'HOME': os.environ['HOME'], 'PATH': f'{folder}/venv/bin:{PATH}'}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
