"""The remapping rules (`-r old:=new`) in the command lines of processes on this machine."""

import shlex
from collections.abc import Iterator
from pathlib import Path

from my_robot_basics.doctor.evidence import Remap

PROCESSES = Path('/proc')


def remaps_in_domain(domain_id: int) -> tuple[Remap, ...]:
    """Return the rules in the command lines of this user's processes in a ROS domain."""
    return tuple(
        remap
        for folder in PROCESSES.iterdir()
        if folder.name.isdigit()
        for remap in remaps_in_command(_words(folder / 'cmdline'))
        if _domain(_words(folder / 'environ')) == f'{domain_id}'
    )


def remaps_in_command(words: list[str]) -> Iterator[Remap]:
    """Yield the rules in one command line."""
    if '--ros-args' not in words:
        return
    for i, word in enumerate(words[:-1]):
        name, is_rule, instead = words[i + 1].partition(':=')
        if word in ('-r', '--remap') and is_rule:
            rest = [*words[:i], *words[i + 2 :]]
            yield Remap(command=shlex.join(rest), name=_slash(name), instead=_slash(instead))


def _slash(name: str) -> str:
    return name if name.startswith('/') else f'/{name}'


def _domain(environment: list[str]) -> str:
    """Return the domain ID in a process's environment, '0' if it has none."""
    return dict(word.partition('=')[::2] for word in environment).get('ROS_DOMAIN_ID') or '0'


def _words(path: Path) -> list[str]:
    try:
        text = path.read_text(encoding='utf-8', errors='replace')
    except OSError:
        return []  # the process has just ended, or belongs to another user
    return [word for word in text.split('\0') if word]
