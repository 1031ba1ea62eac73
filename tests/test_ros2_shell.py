"""`./course ros-shell`: what it sets, which lesson it joins, and what it says."""

import os
import subprocess
import sys
from pathlib import Path

import pexpect
import pytest
from my_robot_basics.ros2 import shell
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session import lessons

TIMEOUT_SEC = 60
RUNNING = [
    lessons.RunningLesson(1_000_000_000, 7, 100, '02_joint_state'),
    lessons.RunningLesson(2_000_000_000, 4, 101, '05_command_line'),
    lessons.RunningLesson(3_000_000_000, 9, 102, '03_publisher'),
]


def run(*arguments, **environment):
    return subprocess.run(
        [sys.executable, '-P', '-m', 'my_robot_basics.ros2.shell', *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
    )


@pytest.mark.parametrize(
    ('wanted', 'domain_id'),
    [
        (None, 9),
        ('05_command_line', 4),
        ('02', 7),
        ('03', 9),
        ('0', 0),
        ('4', 4),
        ('77', 77),
        ('232', 232),
    ],
)
def test_joins_the_lesson_that_started_last_or_the_one_that_is_named(wanted, domain_id):
    assert shell._choose(RUNNING, wanted) == domain_id


def test_without_a_lesson_the_domain_is_that_of_ros():
    assert shell._choose([], None) == 0


@pytest.mark.parametrize('wanted', ['233', '-1', '06_qos', '٣', 'publisher'])
def test_an_unknown_lesson_is_refused_with_those_that_run(wanted):
    with pytest.raises(CommandError, match=r'\(02_joint_state, 05_command_line, 03_publisher\)'):
        shell._choose(RUNNING, wanted)


def test_the_refusal_is_a_line(monkeypatch):
    refused = run('--lesson', 'nowhere', '-c', 'echo ran')
    assert (refused.returncode, refused.stdout) == (2, '')
    assert refused.stderr.startswith("course: --lesson is 'nowhere', expected one of the lessons")
    assert len(refused.stderr.splitlines()) == 1


def test_it_lists_the_lessons_and_marks_the_one_that_is_joined(monkeypatch):
    for name in shell.SHOWN:
        monkeypatch.setenv(name, 'something')
    report = shell._report(RUNNING, 4).splitlines()
    assert report[0] == 'lessons that are running:'
    assert [line.split()[0] for line in report[1:4]] == [lesson.name for lesson in RUNNING]
    assert [line.endswith('<- joined') for line in report[1:4]] == [False, True, False]
    assert shell._report([], 0).splitlines()[0] == 'no lesson is running'


def test_it_says_what_it_sets_and_sets_it():
    done = run('--lesson', '55', '-c', 'env')
    assert done.returncode == 0
    seen = dict(line.split('=', 1) for line in done.stdout.splitlines() if '=' in line)
    said = dict(line.split('=', 1) for line in done.stderr.splitlines() if '=' in line)
    assert set(said) == set(shell.SHOWN)
    assert said.items() <= seen.items()
    assert said['ROS_DOMAIN_ID'] == '55'
    assert said['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'
    # what this Python's wheels need is nobody else's
    assert sys.prefix not in seen.get('LD_LIBRARY_PATH', '')
    assert '_ROS_WHEELS_BOOTSTRAP_COMPLETE' not in seen


def test_a_command_gets_its_words_and_gives_its_status():
    done = run(
        '--', sys.executable, '-c', 'import sys; print(sys.argv[1:]); sys.exit(3)', '-v', 'a b'
    )
    assert (done.returncode, done.stdout) == (3, "['-v', 'a b']\n")


def test_a_command_that_is_not_there_is_named():
    done = run('--', 'no-such-command')
    assert done.returncode == 127
    assert done.stderr.splitlines()[-1] == (
        'course: no-such-command does not start: No such file or directory'
    )


@pytest.fixture
def home(tmp_path):
    """A home whose ~/.bashrc sets up another ROS, as that of many a student does."""
    (tmp_path / '.bashrc').write_text(
        'export ROS_DOMAIN_ID=42 ROS_DISTRO=humble PYTHONPATH=/opt/ros/humble/python\n'
        'export PATH=/opt/ros/humble/bin:$PATH AMENT_PREFIX_PATH=/opt/ros/humble\n'
        'alias mine="echo my alias"\n'
        'PS1="READY "\n'
    )
    return tmp_path


def test_an_open_shell_is_the_users_own_with_the_settings_of_the_course(home):
    environment = {**os.environ, 'HOME': str(home), 'VIRTUAL_ENV': sys.prefix}
    command = ['-P', '-m', 'my_robot_basics.ros2.shell', '--lesson', '55']
    with pexpect.spawn(
        sys.executable, command, env=environment, encoding='utf-8', timeout=TIMEOUT_SEC
    ) as terminal:
        terminal.expect_exact('READY ')
        for line, answer in (
            ('mine', 'my alias'),
            ('echo "<$ROS_DOMAIN_ID$ROS_DISTRO$PYTHONPATH>"', '<55>'),
            ('echo "<$AMENT_PREFIX_PATH>"', f'<{os.environ["AMENT_PREFIX_PATH"]}>'),
            ('command -v ros2', f'{Path(sys.prefix)}/bin/ros2'),
            ('ros2 interface show std_msgs/msg/Int3\t', 'int32 data'),
        ):
            terminal.sendline(line)
            terminal.expect_exact(answer)
