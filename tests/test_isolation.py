"""Without a sandbox: nothing runs and the message says why; with --trust-students, it warns."""

import os
import subprocess
from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import TOY, answered, released_course, submit

from grader.__main__ import main
from grader.autograde.preprocessors import ExecuteRooms
from grader.cli.audiences import describe_audiences
from grader.cli.demo import demo
from grader.common.errors import CourseError
from grader.export.scores import write_scores
from grader.kernels import fork_servers
from grader.kernels import isolation as module
from grader.kernels.isolation import (
    NO_SANDBOX,
    TRUST,
    Protection,
    missing_protection,
    protections,
    require_isolation,
)
from grader.report.feedback import write_feedback
from grader.sandbox import remedies

RIGHT = 'def double(x): return 2 * x'
BWRAP = module.subprocess.run


@pytest.fixture(autouse=True)
def fresh(monkeypatch):
    """Clear the cached protections of this machine before and after a test."""
    monkeypatch.delenv(TRUST, raising=False)
    protections.cache_clear()
    yield
    protections.cache_clear()


@pytest.fixture(scope='module')
def programs_but_bubblewrap(tmp_path_factory):
    folder = tmp_path_factory.mktemp('programs')
    for path in os.environ['PATH'].split(os.pathsep):
        for program in Path(path).glob('*'):
            if program.name != 'bwrap' and not (folder / program.name).is_symlink():
                (folder / program.name).symlink_to(program)
    return folder


@pytest.fixture
def nowhere(monkeypatch, programs_but_bubblewrap):
    """A machine without bubblewrap, for all the processes that grade."""
    monkeypatch.setenv('PATH', str(programs_but_bubblewrap))


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('course'))


def refusing(*options, says='Operation not permitted'):
    """Replace subprocess.run: bwrap refuses some of its options."""

    def run(command, **more):
        if command[0] == 'bwrap' and set(options) & set(command):
            return SimpleNamespace(returncode=1, stderr=f'bwrap: {says}\n', stdout='')
        return BWRAP(command, **more)

    return run


@pytest.mark.isolation
def test_the_test_machine_can_isolate_rooms():
    assert missing_protection() == ''
    assert require_isolation()
    assert len(protections()) == 7


@pytest.mark.isolation
@pytest.mark.parametrize('problem', ['', 'the test says so'])
def test_the_doctor_reports_if_kernels_cannot_be_forked(course, monkeypatch, capsys, problem):
    if problem:
        monkeypatch.setitem(fork_servers._unfit, 'student', problem)
    assert main(['doctor'], course=course) == 0
    assert ('It is slower' in capsys.readouterr().out) is bool(problem)


COUNTED = {
    'there is one': (
        'echo "version 2: memory, pids"',
        '  ok       a cgroup for each room (version 2: m',
    ),
    'there is none': ('echo "nothing delegated" >&2; exit 1', '  without  a cgroup for each room'),
}


@pytest.mark.parametrize(('tried', 'said'), COUNTED.values(), ids=COUNTED)
def test_the_doctor_reports_whether_rooms_have_cgroups(course, monkeypatch, capsys, tried, said):
    monkeypatch.setattr(module, 'command_in_scope', lambda command: ('sh', '-c', tried))
    assert main(['doctor'], course=course) == 0
    told = capsys.readouterr().out
    assert said in told
    assert ('nothing delegated' in told) is ('exit 1' in tried)


REFUSALS = {
    'no user namespaces': ('--unshare-user', 'files and rights of its own'),
    'no network namespaces': ('--unshare-net', 'a network of its own'),
    'no fresh /proc': ('--proc', 'processes of its own'),
    'nested user namespaces': ('--disable-userns', 'no further namespaces'),
}


@pytest.mark.parametrize(('option', 'name'), REFUSALS.values(), ids=REFUSALS)
def test_only_the_missing_protection_is_reported(monkeypatch, option, name):
    monkeypatch.setattr(module.subprocess, 'run', refusing(option))
    assert f'Missing: {name}' in missing_protection()
    assert 'Operation not permitted' in missing_protection()
    assert sum(bool(protection.problem) for protection in protections()) == 1


SETTINGS = {
    'kernel/apparmor_restrict_unprivileged_userns': ('1', 'userns=0'),
    'kernel/unprivileged_userns_clone': ('0', 'userns_clone=1'),
    'user/max_user_namespaces': ('0', 'max_user_namespaces=10000'),
}


@pytest.mark.parametrize(('setting', 'said'), SETTINGS.items(), ids=SETTINGS)
def test_the_remedy_fits_what_the_system_forbids(monkeypatch, setting, said):
    value, remedy = said
    monkeypatch.setattr(remedies, '_setting', lambda name: value if name == setting else '')
    monkeypatch.setattr(module.subprocess, 'run', refusing('--unshare-user'))
    assert f'sudo sysctl -w {setting.replace("/", ".").rpartition(".")[0]}' in missing_protection()
    assert remedy in missing_protection()


@pytest.mark.parametrize(
    ('what', 'said'),
    [
        ('container', 'This is a container that allows too little'),
        ('WSL', 'wsl --set-version'),
        ('', '5.14'),
    ],
)
def test_the_remedy_fits_the_kind_of_machine(monkeypatch, what, said):
    monkeypatch.setattr(remedies, '_in_container', lambda: what == 'container')
    monkeypatch.setattr(remedies, '_setting', lambda name: '')
    wsl = '4.4.0-19041-Microsoft' if what == 'WSL' else '6.1.0'
    monkeypatch.setattr(remedies.platform, 'release', lambda: wsl)
    monkeypatch.setattr(module.subprocess, 'run', refusing('--unshare-user'))
    assert said in missing_protection()


def test_an_old_bubblewrap_is_not_enough(monkeypatch):
    def run(command, **more):
        return SimpleNamespace(returncode=0, stdout='bubblewrap 0.6.1\n', stderr='')

    monkeypatch.setattr(module.subprocess, 'run', run)
    assert 'bubblewrap 0.8 or newer: this one is bubblewrap 0.6.1' in missing_protection()


def test_a_sandbox_that_fails_as_a_whole_is_reported_as_missing(monkeypatch):
    monkeypatch.setattr('grader.sandbox.bubblewrap._HOLD', 'echo no mounts >&2; exit 1')
    assert 'all of it together' in missing_protection()
    assert 'no mounts' in missing_protection()


def test_no_student_code_runs_without_a_sandbox(course, nowhere, capsys, tmp_path):
    ran = tmp_path / 'it_ran'
    submit(course, 'ada', answered(course, f"open('{ran}', 'w')"))
    assert main(['grade'], course=course) == 1
    said = capsys.readouterr().err
    assert 'sudo apt install bubblewrap' in said
    assert '--trust-students' in said
    assert main(['doctor'], course=course) == 1
    told = capsys.readouterr().out
    assert missing_protection()[1:] in told  # the same text
    assert missing_protection() in said
    assert not ran.exists()
    with pytest.raises(CourseError, match='nothing was run'):
        require_isolation()


@pytest.mark.slow
def test_a_grade_without_a_sandbox_is_marked_in_report_feedback_and_scores(
    course, nowhere, capsys
):
    submit(course, 'ada', answered(course, 'def double(x):\n    return 2 * x + x // 7'))
    assert main(['grade', '--trust-students', '--student', 'ada'], course=course) == 0
    first, head, row, *_ = capsys.readouterr().out.splitlines()
    assert first.startswith(NO_SANDBOX.capitalize())
    assert head.startswith('student')
    assert 'expected' in row or 'count again' in row
    assert NO_SANDBOX not in row
    (page,) = write_feedback(course)
    html = page.read_text(encoding='utf-8')
    assert html.count(NO_SANDBOX.capitalize()) == 1
    assert html.index(NO_SANDBOX.capitalize()) < html.index('<table')
    rows = write_scores(course).read_text(encoding='utf-8').splitlines()
    graded = [row for row in rows if row.startswith('ada') and ',double-' in row]
    assert graded
    assert all(NO_SANDBOX in row for row in graded)


@pytest.mark.slow
def test_the_demo_says_that_its_samples_had_no_sandbox(course, nowhere, capsys, tmp_path):
    samples = tmp_path / 'samples'
    samples.mkdir()
    nbformat.write(answered(course, RIGHT), samples / f'{TOY}-pass-right.ipynb')
    demo(samples, root=course.root)
    first, *others = capsys.readouterr().out.splitlines()
    assert NO_SANDBOX in first
    assert not any(NO_SANDBOX in line for line in others)


@pytest.mark.slow
@pytest.mark.isolation
def test_trust_students_changes_nothing_if_there_is_a_sandbox(course):
    assert require_isolation(trust_students=True)
    submit(course, 'bob', answered(course, RIGHT))
    assert main(['grade', '--trust-students', '--student', 'bob'], course=course) == 0
    rows = write_scores(course).read_text(encoding='utf-8').splitlines()
    assert not [row for row in rows if row.startswith('bob') and NO_SANDBOX in row]


def test_nbgraders_own_commands_trust_students_by_an_environment_variable(nowhere, monkeypatch):
    assert not ExecuteRooms().trust_students
    assert not require_isolation(trust_students=True)
    monkeypatch.setenv(TRUST, '1')
    assert not require_isolation()
    monkeypatch.setenv(TRUST, '')
    with pytest.raises(CourseError):
        require_isolation()


@pytest.mark.isolation
def test_isolation_can_be_checked_inside_a_running_event_loop():
    import asyncio

    async def formgrader():
        return require_isolation()

    assert asyncio.run(formgrader())
    assert subprocess.run is BWRAP


@pytest.mark.parametrize('lacking', ['', 'a network of its own (network namespace)'])
def test_the_doctor_reports_whose_nodes_can_meet_and_if_a_hub_is_impossible(lacking):
    machine = [
        Protection(name='files', problem='it is broken'),
        Protection(name=lacking or 'x', problem='no' if lacking else ''),
    ]
    said = list(describe_audiences(machine))
    assert any('any user of the machine who sets the same ROS domain' in line for line in said)
    assert any('without a network of its own' in line for line in said) is bool(lacking)
