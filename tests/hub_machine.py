"""A JupyterHub as deploy/jupyterhub/ sets it up, with users of this machine; all ends with it."""

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
"""As in jupyterhub.service."""
UP_SEC = STOP_SEC = 60.0
PASSWORD = 'only-while-this-test-runs'

needs_root = pytest.mark.skipif(
    os.geteuid() != 0, reason='a hub starts servers of other users, and so is run as root'
)


@dataclass(frozen=True)
class HubMachine:
    """A hub that runs, its users, and where its parts lie."""

    folder: Path
    """What `install` was told: the hub, its environment and class.toml."""
    instructor: str
    students: tuple[str, ...]

    @property
    def settings(self) -> dict[str, str]:
        """What class.toml says."""
        return tomllib.loads((self.folder / 'class.toml').read_text(encoding='utf-8'))

    @property
    def address(self) -> str:
        """Where browsers connect."""
        return self.settings['address']

    @property
    def checkout(self) -> Path:
        """The instructor's folder."""
        return Path(self.settings['checkout'])

    @property
    def of_course(self) -> Path:
        """The course's folder in nbgrader's exchange."""
        return Path(self.settings['exchange'], self.settings['course'])

    @contextmanager
    def serving(self) -> Iterator[Path]:
        """Let `./course serve` of the instructor watch the exchange; give its log."""
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
    """Return the variables of a service: none of a test session or of another environment."""
    names = {name for name in os.environ if name.startswith(('PIP_', 'UV_', 'NODE_'))}
    kept = {name: os.environ[name] for name in {*KEPT, *names} if name in os.environ}
    return kept | {'PATH': PATH, 'HOME': '/root', 'LC_ALL': 'C.UTF-8'}


def as_user(name: str) -> list[str]:
    """Return what runs the command behind it as a user of this machine."""
    return ['runuser', '-u', name, '--', 'env', f'HOME=/home/{name}']


@contextmanager
def user(name: str, *groups: str) -> Iterator[None]:
    """Give this machine a user, as the README says, and take them back with all of theirs."""
    add = ['useradd', '--create-home', '--key', 'HOME_MODE=0700', '--shell', '/bin/bash']
    subprocess.run([*add, *(['--groups', *groups] if groups else []), name], check=True)
    try:
        subprocess.run(['chpasswd'], input=f'{name}:{PASSWORD}\n', text=True, check=True)
        yield
    finally:
        for process in psutil.process_iter(['username']):  # a user with processes cannot go
            if process.info['username'] == name:
                process.kill()
        shutil.rmtree(f'/home/{name}')  # userdel would lock the list of users for as long
        subprocess.run(['userdel', '--force', name], check=True)


@contextmanager
def group(name: str) -> Iterator[None]:
    """Give this machine a group, and take it back."""
    subprocess.run(['groupadd', name], check=True)
    try:
        yield
    finally:
        subprocess.run(['groupdel', name], check=True)


@contextmanager
def hub_machine(number_of_students: int = 2) -> Iterator[HubMachine]:
    """Set a hub up by `install`, from the files of this checkout, and run it."""
    mine = os.getpid()
    students = tuple(f'{name}{mine}' for name in ('ada', 'bob'))
    students += tuple(f'eve{mine}no{number}' for number in range(2, number_of_students))
    instructor = f'ruth{mine}'
    with ExitStack() as stack:
        # rooms show no /tmp of others, and nobody else can look into pytest's folders
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
    """Write class.toml: as it comes, with names and folders of this hub alone."""
    settings = tomlkit.parse((DEPLOY / 'class.toml').read_text(encoding='utf-8'))
    with socket.create_server(('127.0.0.1', 0)) as free:
        settings['address'] = f'http://127.0.0.1:{free.getsockname()[1]}'
    settings['students'], settings['instructor'] = students, machine.instructor
    settings['checkout'] = f'/home/{machine.instructor}/my_robot_basics'
    for name in ('bundle', 'exchange', 'run'):
        settings[name] = str(machine.folder / name)
    (machine.folder / 'class.toml').write_text(tomlkit.dumps(settings), encoding='utf-8')


def set_up(machine: HubMachine) -> None:
    """Give the instructor a checkout, and let it set the hub up."""
    fresh_clone(machine.checkout)
    for made in (machine.checkout, machine.checkout.parent):
        subprocess.run(['chown', '-R', machine.instructor, made], check=True)
    tools = machine.folder / 'tools'
    tools.mkdir()
    shutil.copy(Path(sys.executable).with_name('uv'), tools)  # pip needs minutes more
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
    """Run the hub, as its service does, and end it with all that it has started."""
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
