"""Two hosts on one machine: network namespaces with a cable between them, and a TLS authority.

A process in such a namespace has no other network. It needs root and Debian's package iproute2.
"""

import os
import shutil
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

BITS = 24
HERE, THERE = '10.213.77.1', '10.213.77.2'
EC = ('-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes')


def run(*command: object) -> None:
    subprocess.run([*map(str, command)], check=True, capture_output=True)


class Hosts:
    """The namespaces, by their addresses. `end` removes them."""

    def __init__(self) -> None:
        if os.geteuid() != 0:
            pytest.skip('only root can make network namespaces')
        for program in ('ip', 'nsenter', 'openssl'):
            if not shutil.which(program):
                pytest.skip(f'there is no {program}: sudo apt install iproute2 openssl')
        self.names = {
            HERE: f'course-{os.getpid()}-here',
            THERE: f'course-{os.getpid()}-there',
        }
        self.cables = {HERE: 'cable-here', THERE: 'cable-there'}
        here, there = self.names.values()
        for name in self.names.values():
            run('ip', 'netns', 'add', name)
        cable = ('type', 'veth', 'peer', 'name', self.cables[THERE], 'netns', there)
        run('ip', '-n', here, 'link', 'add', self.cables[HERE], *cable)
        for address, name in self.names.items():
            run(
                'ip',
                '-n',
                name,
                'address',
                'add',
                f'{address}/{BITS}',
                'dev',
                self.cables[address],
            )
            for link in ('lo', self.cables[address]):
                run('ip', '-n', name, 'link', 'set', link, 'up')

    def on(self, address: str) -> tuple[str, ...]:
        """Return the beginning of a command that runs the rest on a host.

        It is not `ip netns exec`, which hides /sys/fs/cgroup.
        """
        return ('nsenter', f'--net=/run/netns/{self.names[address]}', '--')

    def lose(self, address: str, process: subprocess.Popen) -> None:
        """Cut a host off without a message to the other, and kill the processes started there."""
        run('ip', '-n', self.names[address], 'link', 'set', self.cables[address], 'down')
        started = psutil.Process(process.pid)
        for each in [started, *started.children(recursive=True)]:
            with suppress(psutil.NoSuchProcess):
                each.send_signal(signal.SIGKILL)

    def end(self) -> None:
        for name in self.names.values():
            run('ip', 'netns', 'delete', name)


class Authority:
    """Signs certificates of hosts; only these tests trust it."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.folder, self.file, self.key = folder, folder / 'ca.pem', folder / 'ca.key'
        name = ('-subj', f'/CN={folder.name}', '-keyout', self.key, '-out', self.file)
        run('openssl', 'req', '-x509', *EC, '-days', '2', *name)

    def options(self, host: str) -> list[str]:
        """Return the options of Dask and of `./course grade` for a certificate of this host."""
        cert, key, wanted = (self.folder / f'{host}.{end}' for end in ('pem', 'key', 'csr'))
        if not cert.exists():
            run('openssl', 'req', *EC, '-subj', f'/CN={host}', '-keyout', key, '-out', wanted)
            signed = ('-CA', self.file, '-CAkey', self.key, '-CAcreateserial', '-days', '2')
            run('openssl', 'x509', '-req', '-in', wanted, '-out', cert, *signed)
        names = ('--tls-ca-file', '--tls-cert', '--tls-key')
        return [
            str(each) for pair in zip(names, (self.file, cert, key), strict=True) for each in pair
        ]
