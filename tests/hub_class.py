"""A class on a hub of this machine, for tests and benchmarks: users, hub, proxy, exchange."""

import grp
import os
import pwd
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import urllib.request
from contextlib import contextmanager, suppress
from pathlib import Path

from fresh_machine import fresh_clone

ROOT = Path(__file__).parents[1]
TEACHER, STUDENTS, GROUP = 'course-teacher', ('course-ada', 'course-bob'), 'course-students'
PASSWORD = 'a-password-of-this-test'
COURSE = 'robots'
PATIENCE_SEC = 180.0


class Hub:
    """What `deploy/jupyterhub/install` makes of a machine."""

    def __init__(self, folder, students):
        self.folder, self.students = folder, students
        self.hub, self.exchange = folder / 'jupyterhub', folder / 'exchange'
        self.address = f'http://127.0.0.1:{free_port()}'
        self.processes = []

    @property
    def checkout(self):
        return Path(f'~{TEACHER}').expanduser() / 'my_robot_basics'

    def settings(self):
        text = (ROOT / 'deploy/jupyterhub/class.toml').read_text()
        mine = {
            'course': COURSE,
            'students': GROUP,
            'instructor': TEACHER,
            'checkout': self.checkout,
            'bundle': self.folder / 'bundle',
            'exchange': self.exchange,
            'run': self.folder / 'run',
            'address': self.address,
        }
        lines = [
            f'{name} = "{mine[name]}"' if (name := line.split(' = ')[0]) in mine else line
            for line in text.splitlines()
        ]
        return '\n'.join(lines)

    def install(self):
        add_users((TEACHER,), ())
        add_users(self.students, (GROUP,))
        fresh_clone(self.checkout)
        subprocess.run(['chown', '-R', f'{TEACHER}:', self.checkout], check=True)
        self.hub.mkdir()
        (self.hub / 'class.toml').write_text(self.settings())
        command = [self.checkout / 'deploy/jupyterhub/install', '--no-start', self.hub]
        variables = os.environ | {'PYTHON': '/usr/bin/python3'}
        run = subprocess.run(command, env=variables, capture_output=True, text=True)
        assert run.returncode == 0, run.stdout + run.stderr

    def start(self, user, *command, folder, **variables):
        """Start a program as a user; it is ended with the hub. Return its process."""
        log = (self.folder / f'log-{len(self.processes)}').open('w')
        process = subprocess.Popen(
            [*as_user(user), *command],
            cwd=folder,
            env=clean(user) | variables,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self.processes.append(process)
        return process

    def start_hub(self):
        self.start(
            'root',
            self.hub / 'venv/bin/jupyterhub',
            *('-f', self.hub / 'jupyterhub_config.py'),
            f'--ConfigurableHTTPProxy.api_url=http://127.0.0.1:{free_port()}',
            # tests ask JupyterLab itself what is open
            '--RoomSpawner.args=--LabApp.expose_app_in_browser=True',
            folder=self.hub / 'state',
        )
        deadline = time.monotonic() + PATIENCE_SEC
        while True:
            try:
                return urllib.request.urlopen(f'{self.address}/hub/api/').close()
            except OSError:
                assert self.processes[0].poll() is None, self.logs()
                assert time.monotonic() < deadline, self.logs()
                time.sleep(0.3)

    def teach(self, *command, **variables):
        """Run a command of the instructor in the checkout."""
        run = subprocess.run(
            [*as_user(TEACHER), *command],
            cwd=self.checkout,
            env=clean(TEACHER) | {'JUPYTER_CONFIG_PATH': str(self.hub / 'nbgrader')} | variables,
            capture_output=True,
            text=True,
        )
        assert run.returncode == 0, run.stdout + run.stderr
        return run.stdout

    def logs(self):
        return '\n'.join(log.read_text() for log in sorted(self.folder.glob('log-*')))

    def stop(self):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def free_port():
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        return free.getsockname()[1]


def as_user(user):
    return (
        []
        if user == 'root'
        else ['setpriv', f'--reuid={user}', f'--regid={user}', '--init-groups']
    )


def clean(user):
    """The variables of a user, without what a test session sets."""
    not_theirs = (
        'PYTEST_',
        'COV_',
        'MY_ROBOT_BASICS_',
        'ROS_',
        'JUPYTER',
        'VIRTUAL_ENV',
        'PYTHON',
    )
    kept = {k: v for k, v in os.environ.items() if not k.startswith(not_theirs)}
    return kept | {'HOME': pwd.getpwnam(user).pw_dir, 'USER': user, 'LOGNAME': user}


def add_users(names, groups):
    for group in groups:
        with suppress(KeyError):
            grp.getgrnam(group)
            continue
        subprocess.run(['groupadd', group], check=True)
    for name in names:
        options = [
            '--create-home',
            '--user-group',
            '--shell',
            '/bin/bash',
            '--key',
            'HOME_MODE=0700',
        ]
        subprocess.run(['useradd', *options, '--groups', ','.join(groups), name], check=True)
    entered = ''.join(f'{name}:{PASSWORD}\n' for name in names)
    subprocess.run(['chpasswd'], input=entered, text=True, check=True)


def remove_users(names):
    for name in names:
        subprocess.run(['userdel', '--remove', name], capture_output=True)
    subprocess.run(['groupdel', GROUP], capture_output=True)


@contextmanager
def hub_of_a_class(students=STUDENTS):
    """Yield a hub that runs; with the `with`, its users and all that it made are gone."""
    remove_users([TEACHER, *students])  # of a run that was killed
    folder = Path(tempfile.mkdtemp(prefix='hub-', dir='/var/tmp'))
    folder.chmod(0o755)
    hub = Hub(folder, students)
    try:
        hub.install()
        hub.start_hub()
        yield hub
    finally:
        hub.stop()
        remove_users([TEACHER, *students])
        shutil.rmtree(folder, ignore_errors=True)
