"""Each cause that prevents a sandbox is reported, with the smallest change that allows one."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from grader.course import ROOT
from grader.sandbox import remedies

UNDER = (sys.executable, Path(__file__).with_name('seccomp_profile.py'))
PROBE = (sys.executable, '-P', '-m', 'grader.sandbox.block_probe')
PROFILE = ROOT / remedies.PROFILE
NAMESPACES = 0x7E020000
SANDBOX = (
    *('bwrap', '--unshare-user', '--unshare-net', '--unshare-pid', '--unshare-uts'),
    *('--hostname', 'room', '--ro-bind', '/', '/', '--proc', '/proc', '--disable-userns', 'true'),
)
APART = ('bwrap', '--dev-bind', '/', '/')
pytestmark = pytest.mark.isolation


def script():
    spec = importlib.util.spec_from_file_location(
        'make_seccomp_profile', ROOT / 'deploy/make_seccomp_profile.py'
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def default(tmp_path):
    """Docker's default profile, for a container without capabilities: ours less what it adds."""
    added = set(script().ADDED)
    profile = json.loads(PROFILE.read_text())
    profile['syscalls'][0]['names'] = [
        name for name in profile['syscalls'][0]['names'] if name not in added
    ]
    flags = {'index': 0, 'value': NAMESPACES, 'valueTwo': 0, 'op': 'SCMP_CMP_MASKED_EQ'}
    profile['syscalls'].append({'names': ['clone'], 'action': 'SCMP_ACT_ALLOW', 'args': [flags]})
    path = tmp_path / 'default.json'
    path.write_text(json.dumps(profile))
    return path


def without(name, folder):
    """Return our profile less one system call."""
    profile = json.loads(PROFILE.read_text())
    profile['syscalls'][0]['names'].remove(name)
    path = folder / 'less.json'
    path.write_text(json.dumps(profile))
    return path


def said(*command):
    run = subprocess.run([*command, *PROBE], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def works(*command):
    return subprocess.run([*command, *SANDBOX], capture_output=True).returncode == 0


def advice(block, monkeypatch, *, container=True):
    monkeypatch.setattr(remedies, '_first_block', lambda: block)
    monkeypatch.setattr(remedies, '_in_container', lambda: container)
    monkeypatch.setattr(remedies, '_setting', lambda name: '')
    return remedies.remedy()


def test_nothing_is_reported_on_a_machine_that_allows_sandboxes():
    assert said() == ''
    assert works()


def test_dockers_default_profile_is_reported_as_the_cause(default, monkeypatch):
    assert not works(*UNDER, default)
    assert said(*UNDER, default) == 'filter unshare EPERM'
    text = advice('filter unshare EPERM', monkeypatch)
    assert '--security-opt seccomp=deploy/seccomp.json' in text
    assert 'unconfined' not in text
    assert 'SystemCallFilter=' in advice('filter unshare EPERM', monkeypatch, container=False)


def test_our_profile_allows_sandboxes_and_needs_each_call_that_it_adds(tmp_path):
    assert works(*UNDER, PROFILE)
    assert said(*UNDER, PROFILE) == ''
    for name in script().ADDED:
        less = without(name, tmp_path)
        assert said(*UNDER, less) == f'filter {name} EPERM'
        assert works(*UNDER, less) is (name == 'setns')  # which nsenter needs, to join a room


@pytest.mark.parametrize(
    'masked', [('--ro-bind', '/proc/sys', '/proc/sys'), ('--tmpfs', '/proc/fs')]
)
def test_a_masked_proc_is_reported(masked, monkeypatch):
    assert said(*APART, *masked) == 'proc EPERM'
    assert not works(*APART, *masked)
    mounts = f'40 22 0:1 / {masked[-1]} ro - proc proc ro'
    monkeypatch.setattr(remedies, '_read', lambda path: mounts)
    text = advice('proc EPERM', monkeypatch)
    assert f'/proc is masked ({masked[-1]})' in text
    assert '--security-opt systempaths=unconfined (Docker)' in text
    assert '--security-opt unmask=ALL (Podman)' in text
    assert 'seccomp' not in text


def test_an_exhausted_limit_of_user_namespaces_is_reported(monkeypatch):
    none_left = (*APART, '--unshare-user', '--disable-userns')
    assert said(*none_left) == 'user ENOSPC'
    assert not works(*none_left)
    assert 'user.max_user_namespaces=10000' in advice('user ENOSPC', monkeypatch)


def test_apparmor_is_reported_as_the_cause(monkeypatch):
    monkeypatch.setattr(remedies, '_read', lambda path: 'docker-default (enforce)')
    text = advice('mounting EACCES', monkeypatch)
    assert text.startswith('docker-default (enforce) forbids what bubblewrap does first')
    assert '--security-opt apparmor=unconfined' in text
    assert 'seccomp' not in text


def test_a_restrictive_sysctl_is_reported_before_an_apparmor_profile(monkeypatch):
    monkeypatch.setattr(remedies, '_first_block', lambda: 'uid_map EACCES')
    monkeypatch.setattr(
        remedies, '_setting', lambda name: '1' if 'apparmor_restrict' in name else ''
    )
    assert 'kernel.apparmor_restrict_unprivileged_userns=0' in remedies.remedy()


def test_root_without_capabilities_is_advised_to_use_an_ordinary_user(monkeypatch):
    monkeypatch.setattr(os, 'geteuid', lambda: 0)
    monkeypatch.setattr(remedies, '_has_sys_admin', lambda: False)
    assert '--user 1000:1000' in advice('', monkeypatch)


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can lose what root has')
def test_the_sys_admin_capability_of_root_is_detected():
    code = 'from grader.sandbox import remedies; print(remedies._has_sys_admin())'
    lose = ('setpriv', '--bounding-set', '-sys_admin', '--inh-caps', '-sys_admin')
    for command, found in ((), 'True'), (lose, 'False'):
        run = subprocess.run(
            [*command, sys.executable, '-P', '-c', code], capture_output=True, text=True
        )
        assert run.stdout.strip() == found, run.stderr


def test_our_profile_adds_seven_calls_to_dockers():
    made = script()
    profile = json.loads(PROFILE.read_text())
    allowed = set(profile['syscalls'][0]['names'])
    blocked = {name for names in made.BLOCKED.values() for name in names.split()}
    assert len(made.ADDED) == 7
    assert allowed >= set(made.ADDED)
    assert allowed & blocked == set()
    assert not allowed & {'socket', 'personality', 'clone3'}  # they have rules of their own
    assert profile['defaultAction'] == 'SCMP_ACT_ERRNO'
    assert made.profile()['syscalls'][1:] == profile['syscalls'][1:]
