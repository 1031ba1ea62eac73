"""The folder in which cgroups can be made, on machines of all kinds."""

import os
import subprocess
from pathlib import Path

import pytest

from grader.autograde import preprocessors
from grader.sandbox import cgroup_hierarchies as module
from grader.sandbox import systemd_scopes
from grader.sandbox.cgroup_hierarchies import GRADERS, NoCgroups, command_in_scope
from grader.workers import dask_worker, workers

OFF = 'cpu io memory pids'


@pytest.fixture(autouse=True)
def fresh():
    """Clear the cached facts about this machine, before and after a test."""
    caches = (module._found, systemd_scopes.has_scopes)
    for each in caches:
        each.cache_clear()
    yield
    for each in caches:
        each.cache_clear()


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Makes files that describe a machine: its cgroups, its mounts and its user."""

    def make(cgroup, mounts, *, root=True, systemd=True):
        (tmp_path / 'cgroup').write_text(cgroup)
        lines = [
            f'30 24 0:26 {part} {tmp_path / where} rw,nosuid shared:9 - {kind} none rw,{more}\n'
            for part, where, kind, more in mounts
        ]
        (tmp_path / 'mountinfo').write_text(
            '24 1 8:1 / / rw - ext4 /dev/sda rw\n' + ''.join(lines)
        )
        monkeypatch.setattr(os, 'geteuid', lambda: 0 if root else 1000)
        for each in (module, systemd_scopes):
            monkeypatch.setattr(each, 'SYSTEMD', tmp_path if systemd else tmp_path / 'none')
        return tmp_path

    return make


def tree(folder, *, processes='', controllers=OFF, is_root=False):
    """Make a folder look like a cgroup of version 2."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / 'cgroup.procs').write_bytes(processes.encode())  # `switches` counts no move
    (folder / 'cgroup.controllers').write_text(controllers)
    (folder / 'cgroup.subtree_control').write_text('')
    if not is_root:
        (folder / 'cgroup.type').write_text('domain')


@pytest.fixture
def switches(monkeypatch):
    """Let control files behave like those of Linux: enabled controllers stay enabled."""
    write = Path.write_text
    moved = []

    def write_text(self, text, **options):
        if self.name == 'cgroup.subtree_control':
            on = self.read_text().split() if self.exists() else []
            text = ' '.join([*on, text.removeprefix('+')])
        if self.name == 'cgroup.procs' and text:
            moved.append((self.parent.name, text))
            old = self.parents[1] / 'cgroup.procs'
            write(old, ' '.join(p for p in old.read_text().split() if p != text))
        return write(self, text, **options)

    monkeypatch.setattr(Path, 'write_text', write_text)
    return moved


def found(proc):
    where = module._found(proc)
    if isinstance(where, NoCgroups):
        raise where
    return where


V1 = [('/', name, 'cgroup', name) for name in ('memory', 'pids')] + [
    ('/', 'cpu', 'cgroup', 'cpu,cpuacct')
]


def test_version_1_has_a_hierarchy_for_each_controller(machine):
    proc = machine('4:memory:/session\n3:pids:/\n1:cpu,cpuacct:/work\n0::/\n', V1)
    for name in ('memory/session', 'pids', 'cpu/work'):
        (proc / name).mkdir(parents=True)
    where = found(proc)
    assert (where.version, list(where.folders)) == (1, ['memory', 'pids', 'cpu', 'cpuacct'])
    assert where.folders['memory'] == proc / 'memory' / 'session'
    assert where.folders['cpu'] == proc / 'cpu' / 'work'


def test_a_container_sees_its_own_part_of_version_1(machine):
    mounts = [('/docker/abc', name, 'cgroup', name) for name in ('memory', 'pids')]
    proc = machine('4:memory:/docker/abc\n3:pids:/docker/abc\n', mounts)
    for name in ('memory', 'pids'):
        (proc / name).mkdir()
    assert found(proc).folders == {name: proc / name for name in ('memory', 'pids')}


@pytest.mark.parametrize('lacking', ['memory', 'pids'])
def test_version_1_is_refused_without_memory_or_pids_controller(machine, lacking):
    proc = machine('4:memory:/\n3:pids:/\n', V1)
    for name in {'memory', 'pids'} - {lacking}:
        (proc / name).mkdir()
    with pytest.raises(NoCgroups, match=f'{lacking} cannot be used by this user'):
        found(proc)


V2 = [('/', 'unified', 'cgroup2', 'nsdelegate')]


@pytest.mark.parametrize(('name', 'marked'), [('run-7.scope', b'1'), ('mrb-7.scope', b'')])
def test_a_delegated_scope_is_used_with_its_processes_moved_aside(
    machine, switches, monkeypatch, name, marked
):
    monkeypatch.setattr(os, 'getxattr', lambda path, name: marked)
    proc = machine(f'0::/user.slice/{name}\n', V2, root=False)
    tree(proc / 'unified', is_root=True)
    scope = proc / 'unified' / 'user.slice' / name
    tree(scope, processes='41 42')
    where = found(proc)
    assert (where.version, set(where.folders.values())) == (2, {scope})
    assert switches == [(GRADERS, '41'), (GRADERS, '42')]
    assert set((scope / 'cgroup.subtree_control').read_text().split()) == {'memory', 'pids', 'cpu'}


def test_a_process_moved_aside_finds_the_same_scope_again(machine, switches):
    proc = machine(f'0::/run-7.scope/{GRADERS}\n', V2, root=False)
    tree(proc / 'unified' / 'run-7.scope' / GRADERS, processes='41')
    tree(proc / 'unified' / 'run-7.scope')
    assert set(found(proc).folders.values()) == {proc / 'unified' / 'run-7.scope'}
    assert switches == []


def test_a_container_uses_its_whole_cgroup_tree(machine, switches):
    proc = machine('0::/\n', V2)
    tree(proc / 'unified', processes='1 7')
    assert set(found(proc).folders.values()) == {proc / 'unified'}
    assert [process for _, process in switches] == ['1', '7']


def test_root_uses_the_whole_tree_without_systemd(machine, switches):
    proc = machine('0::/some/daemon\n', V2, systemd=False)
    tree(proc / 'unified', processes='1 7', is_root=True)
    tree(proc / 'unified' / 'some' / 'daemon', processes='9')
    assert set(found(proc).folders.values()) == {proc / 'unified'}
    assert switches == []


def test_a_cgroup_that_systemd_has_not_delegated_is_refused(machine, switches):
    proc = machine('0::/user.slice/session-3.scope\n', V2)
    tree(proc / 'unified', is_root=True)
    tree(proc / 'unified' / 'user.slice' / 'session-3.scope', processes='41')
    with pytest.raises(NoCgroups, match=r'session-3\.scope cannot be used by this user'):
        found(proc)
    assert switches == []


def test_a_cgroup_without_the_memory_controller_is_refused(machine, switches):
    proc = machine('0::/\n', V2)
    tree(proc / 'unified', controllers='hugetlb pids')
    with pytest.raises(NoCgroups, match='no controller for memory'):
        found(proc)


def test_a_machine_without_cgroups_is_reported(machine):
    with pytest.raises(NoCgroups, match='this Linux has no cgroups'):
        found(machine('', []))
    module._found.cache_clear()
    with pytest.raises(NoCgroups, match='not mounted here'):
        found(machine('0::/\n', []))


def answering(code):
    """Replace subprocess.run: systemd-run ends with a code."""
    return lambda command, **more: subprocess.CompletedProcess(command, code)


@pytest.fixture
def nowhere(machine, monkeypatch):
    """A systemd machine whose session this user cannot use."""
    proc = machine('0::/user.slice/session-3.scope\n', V2, root=False)
    tree(proc / 'unified', is_root=True)
    tree(proc / 'unified' / 'user.slice' / 'session-3.scope', processes='41')
    problem = module._found(proc)
    monkeypatch.setattr(module, '_found', lambda proc: problem)
    monkeypatch.setattr(
        systemd_scopes, 'own_paths', lambda proc: {'': '/user.slice/session-3.scope'}
    )
    monkeypatch.setattr(systemd_scopes.shutil, 'which', lambda tool: f'/usr/bin/{tool}')
    return monkeypatch


def test_the_command_runs_in_a_delegated_systemd_user_scope(nowhere):
    nowhere.setattr(systemd_scopes.subprocess, 'run', answering(0))
    command = command_in_scope(('python', 'x'))
    assert command[:3] == ('systemd-run', '--user', '--scope')
    assert command[-3:] == ('--', 'python', 'x')
    assert '-pDelegate=yes' in command
    # each has a unit of its own
    assert len({command_in_scope(('python', 'x')) for _ in range(3)}) == 3


def test_the_command_is_unchanged_if_systemd_refuses_a_scope(nowhere):
    nowhere.setattr(systemd_scopes.subprocess, 'run', answering(1))
    assert command_in_scope(('python', 'x')) == ('python', 'x')


def test_the_command_is_unchanged_if_cgroups_can_be_made(monkeypatch):
    monkeypatch.setattr(module, '_found', lambda proc: module.Hierarchies(1, {}))
    assert command_in_scope(('python', 'x')) == ('python', 'x')


@pytest.mark.parametrize(
    ('options', 'said'),
    [
        ('quiet', ''),
        ('cgroup.memory=nosocket quiet', 'sockets'),
        ('cgroup.memory=nokmem,nosocket', 'sockets and objects of the kernel'),
        ('xcgroup_memory=nosocket', ''),
    ],
)
def test_kinds_of_memory_that_linux_does_not_count_are_reported(
    tmp_path, monkeypatch, options, said
):
    (tmp_path / 'cmdline').write_text(f'ro {options}\n')
    assert module._uncounted(tmp_path / 'cmdline') == said
    monkeypatch.setattr(module, '_uncounted', lambda: said)
    told = str(module.Hierarchies(2, {'memory': tmp_path}))
    assert told.endswith(f'; without what {said} hold' if said else f'; in {tmp_path}')


@pytest.mark.parametrize(
    'begin',
    [lambda: preprocessors._workers.__wrapped__(), lambda: dask_worker._workers.__wrapped__(1)],
    ids=['nbgrader autograde', 'dask worker'],
)
def test_graders_start_their_workers_in_a_systemd_scope(monkeypatch, begin):
    monkeypatch.setattr(workers, 'command_in_scope', lambda command: ('a scope', *command))
    monkeypatch.setattr('atexit.register', lambda end: None)
    begun = begin()
    begun.__exit__()
    assert begun._command == ('a scope', *workers.COMMAND)
