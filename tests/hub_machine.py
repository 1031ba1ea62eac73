"""A JupyterHub as deploy/jupyterhub/ installs it, with temporary users of this machine."""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil
import pytest
import tomlkit
from fresh_machine import KEPT, ROOT, fresh_clone

DEPLOY = ROOT / 'deploy/jupyterhub'
PATH = '/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin'
"""The PATH of jupyterhub.service."""
UP_SEC = STOP_SEC = 60.0
PASSWORD = 'only-while-this-test-runs'

needs_root = pytest.mark.skipif(
    os.geteuid() != 0, reason='a hub starts servers of other users, and so is run as root'
)


@dataclass(frozen=True)
class HubMachine:
    """A running hub, its users, and the paths of its parts."""

    folder: Path
    """The folder given to `install`: the hub, its environment and class.toml."""
    instructor: str
    students: tuple[str, ...]

    @property
    def settings(self) -> dict[str, str]:
        """The content of class.toml."""
        return tomllib.loads((self.folder / 'class.toml').read_text(encoding='utf-8'))

    @property
    def address(self) -> str:
        """The URL for browsers."""
        return self.settings['address']

    @property
    def checkout(self) -> Path:
        """The instructor's checkout of the course."""
        return Path(self.settings['checkout'])

    @property
    def of_course(self) -> Path:
        """The course's folder in nbgrader's exchange."""
        return Path(self.settings['exchange'], self.settings['course'])

    @contextmanager
    def serving(self) -> Iterator[Path]:
        """Run the instructor's `./course serve` on the exchange; yield its log."""
        log = self.folder / 'serve.log'
        inbound = self.of_course / 'inbound'
        command = [*as_user(self.instructor), './course', 'serve', inbound]
        with log.open('w') as written:
            process = subprocess.Popen(
                command, cwd=self.checkout, env=outside(), stdout=written, stderr=written
            )
        try:
            yield log
        finally:
            process.terminate()
            process.wait(STOP_SEC)


def outside() -> dict[str, str]:
    """Return a service's environment, without variables of a test session or a .venv."""
    names = {name for name in os.environ if name.startswith(('PIP_', 'UV_', 'NODE_'))}
    kept = {name: os.environ[name] for name in {*KEPT, *names} if name in os.environ}
    return kept | {'PATH': PATH, 'HOME': '/root', 'LC_ALL': 'C.UTF-8'}


def as_user(name: str) -> list[str]:
    """Return the beginning of a command that runs the rest as a user of this machine."""
    return ['runuser', '-u', name, '--', 'env', f'HOME=/home/{name}']


@contextmanager
def user(name: str, *groups: str) -> Iterator[None]:
    """Create a user on this machine, as the README says; remove it with its files at the end."""
    add = ['useradd', '--create-home', '--key', 'HOME_MODE=0700', '--shell', '/bin/bash']
    subprocess.run([*add, *(['--groups', *groups] if groups else []), name], check=True)
    try:
        subprocess.run(['chpasswd'], input=f'{name}:{PASSWORD}\n', text=True, check=True)
        yield
    finally:
        for process in psutil.process_iter(['username']):  # userdel refuses if processes run
            if process.info['username'] == name:
                process.kill()
        shutil.rmtree(f'/home/{name}')  # faster here: userdel locks the user database meanwhile
        subprocess.run(['userdel', '--force', name], check=True)


@contextmanager
def group(name: str) -> Iterator[None]:
    """Create a group on this machine, and remove it at the end."""
    subprocess.run(['groupadd', name], check=True)
    try:
        yield
    finally:
        subprocess.run(['groupdel', name], check=True)


@contextmanager
def hub_machine(number_of_students: int = 2) -> Iterator[HubMachine]:
    """Set up a hub by `install`, from the files of this checkout, and run it."""
    mine = os.getpid()
    students = tuple(f'{name}{mine}' for name in ('ada', 'bob'))
    students += tuple(f'eve{mine}no{number}' for number in range(2, number_of_students))
    instructor = f'ruth{mine}'
    with ExitStack() as stack:
        # rooms hide /tmp, and other users can't read pytest's folders
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(dir='/srv', prefix='hub-')))
        folder.chmod(0o755)
        stack.enter_context(group(f'class{mine}'))
        stack.enter_context(user(instructor))
        for student in students:
            stack.enter_context(user(student, f'class{mine}'))
        machine = HubMachine(folder, instructor, students)
        write_settings(machine, f'class{mine}')
        set_up(machine)
        stack.enter_context(running(machine))
        yield machine


def write_settings(machine: HubMachine, students: str) -> None:
    """Write class.toml: the original, with this hub's names and folders."""
    settings = tomlkit.parse((DEPLOY / 'class.toml').read_text(encoding='utf-8'))
    with socket.create_server(('127.0.0.1', 0)) as free:
        settings['address'] = f'http://127.0.0.1:{free.getsockname()[1]}'
    settings['students'], settings['instructor'] = students, machine.instructor
    settings['checkout'] = f'/home/{machine.instructor}/my_robot_basics'
    for name in ('bundle', 'exchange', 'run'):
        settings[name] = str(machine.folder / name)
    (machine.folder / 'class.toml').write_text(tomlkit.dumps(settings), encoding='utf-8')


def set_up(machine: HubMachine) -> None:
    """Give the instructor a checkout, and install the hub from it."""
    fresh_clone(machine.checkout)
    for made in (machine.checkout, machine.checkout.parent):
        subprocess.run(['chown', '-R', machine.instructor, made], check=True)
    tools = machine.folder / 'tools'
    tools.mkdir()
    shutil.copy(Path(sys.executable).with_name('uv'), tools)  # with pip it takes minutes longer
    done = subprocess.run(
        [machine.checkout / 'deploy/jupyterhub/install', '--no-start', machine.folder],
        env=outside() | {'PATH': f'{tools}:{PATH}'},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, done.stdout


@contextmanager
def running(machine: HubMachine) -> Iterator[None]:
    """Run the hub as its service does; end it and all that it has started."""
    command = ['../venv/bin/jupyterhub', '-f', '../jupyterhub_config.py']
    said = machine.folder / 'log'
    with said.open('w') as log:
        hub = subprocess.Popen(
            command, cwd=machine.folder / 'state', env=outside(), stdout=log, stderr=log
        )
    try:
        deadline = time.monotonic() + UP_SEC
        while True:
            try:
                urllib.request.urlopen(f'{machine.address}/hub/health').close()
                break
            except urllib.error.URLError:
                assert hub.poll() is None, said.read_text()
                assert time.monotonic() < deadline, said.read_text()
                time.sleep(0.2)
        yield
    finally:
        hub.terminate()
        hub.wait(STOP_SEC)
