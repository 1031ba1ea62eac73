"""A spawner that runs each student's whole server in a room of its own, made by bubblewrap."""

import asyncio
import json
import os
import pwd
import socket
import sys
from pathlib import Path

from jupyterhub.spawner import LocalProcessSpawner
from jupyterhub.traitlets import Command
from traitlets import Dict, List, Unicode
from walls import Room, bubblewrap

INSIDE = Path(__file__).with_name('room.py')
START_TIMEOUT_SEC = 60.0
OWN_FRAMES = {'headers': {'Content-Security-Policy': "frame-ancestors 'self'"}}
"""JupyterLab shows the formgrader in a frame, which JupyterHub's default policy forbids."""


class RoomSpawner(LocalProcessSpawner):
    """Starts servers as LocalProcessSpawner does, but a student's in a room."""

    server_cmd = Command(help="What becomes a student's server.").tag(config=True)
    instructors = Dict(help='Who has no room, and the checkout to work in.').tag(config=True)
    course = Unicode(help='The folder of the unpacked bundle.').tag(config=True)
    exchange = Unicode(help="nbgrader's exchange.").tag(config=True)
    shown = List(help='What else students may read.').tag(config=True)

    async def start(self) -> tuple[str, int]:
        """Start a server; return the address where the proxy reaches it."""
        if checkout := self.instructors.get(self.user.name):
            python = f'{checkout}/.venv/bin/python'
            server = [python, '-P', '-m', 'jupyterhub.singleuser']
            server.append(f'--ServerApp.tornado_settings={OWN_FRAMES}')
            self.cmd = ['env', f'--chdir={checkout}', *server]
            return await super().start()
        return await self.start_in_room()

    async def start_in_room(self) -> tuple[str, int]:
        """Start a server in a room. Raises RuntimeError if the room could not be made."""
        room = Room(
            home=Path(pwd.getpwnam(self.user.name).pw_dir),
            exchange=Path(self.exchange),
            shown=(Path(self.course), INSIDE, *map(Path, self.shown)),
        )
        told, tell = os.pipe()
        # opened outside, where the proxy connects to it, and accepted inside the room
        with socket.create_server(('127.0.0.1', 0), backlog=128) as listening:
            try:
                self.port = listening.getsockname()[1]
                inside = [sys._base_executable, '-IS', INSIDE, listening.fileno(), self.port]
                words = [*bubblewrap(room, tell=tell), *map(str, inside), *self.server_cmd]
                self.cmd = words
                self.popen_kwargs = {'pass_fds': (listening.fileno(), tell)}
                address = await super().start()
            finally:
                os.close(tell)
        # signals go to the room's process 1: when it ends, all processes in the room end
        self.pid = await asyncio.wait_for(
            asyncio.to_thread(first_process, told), START_TIMEOUT_SEC
        )
        return address


def first_process(told: int) -> int:
    """Return the process ID that bwrap reports. Raises RuntimeError if it made no room."""
    with os.fdopen(told) as file:
        text = file.read()
    if not text:
        raise RuntimeError(
            'bubblewrap made no room, expected one for each student: what it said is above in '
            'this log, and ./course doctor says what this machine lacks'
        )
    return int(json.loads(text)['child-pid'])
