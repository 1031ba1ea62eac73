"""`./course ros-shell`: its settings, the lesson that it joins, and its messages."""

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
def test_ros_shell_joins_the_named_lesson_or_the_one_that_started_last(wanted, domain_id):
    assert shell._choose(RUNNING, wanted) == domain_id


def test_ros_shell_joins_domain_0_if_no_lesson_runs():
    assert shell._choose([], None) == 0


@pytest.mark.parametrize('wanted', ['233', '-1', '06_qos', '٣', 'publisher'])
def test_an_unknown_lesson_is_refused_with_the_running_lessons(wanted):
    with pytest.raises(CommandError, match=r'\(02_joint_state, 05_command_line, 03_publisher\)'):
        shell._choose(RUNNING, wanted)


def test_an_unknown_lesson_is_refused_in_one_line(monkeypatch):
    refused = run('--lesson', 'nowhere', '-c', 'echo ran')
    assert (refused.returncode, refused.stdout) == (2, '')
    assert refused.stderr.startswith("course: --lesson is 'nowhere', expected one of the lessons")
    assert len(refused.stderr.splitlines()) == 1


def test_ros_shell_lists_running_lessons_and_marks_the_joined_one(monkeypatch):
    for name in shell.SHOWN:
        monkeypatch.setenv(name, 'something')
    report = shell._report(RUNNING, 4).splitlines()
    assert report[0] == 'lessons that are running:'
    assert [line.split()[0] for line in report[1:4]] == [lesson.name for lesson in RUNNING]
    assert [line.endswith('<- joined') for line in report[1:4]] == [False, True, False]
    assert shell._report([], 0).splitlines()[0] == 'no lesson is running'


def test_ros_shell_reports_the_environment_variables_that_it_sets():
    done = run('--lesson', '55', '-c', 'env')
    assert done.returncode == 0
    seen = dict(line.split('=', 1) for line in done.stdout.splitlines() if '=' in line)
    said = dict(line.split('=', 1) for line in done.stderr.splitlines() if '=' in line)
    assert set(said) == set(shell.SHOWN)
    assert said.items() <= seen.items()
    assert said['ROS_DOMAIN_ID'] == '55'
    assert said['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'
    # settings that only the wheels of this Python need do not reach other programs
    assert sys.prefix not in seen.get('LD_LIBRARY_PATH', '')
    assert '_ROS_WHEELS_BOOTSTRAP_COMPLETE' not in seen


def test_a_command_gets_its_arguments_and_its_exit_status_is_returned():
    done = run(
        '--', sys.executable, '-c', 'import sys; print(sys.argv[1:]); sys.exit(3)', '-v', 'a b'
    )
    assert (done.returncode, done.stdout) == (3, "['-v', 'a b']\n")


def test_a_missing_command_is_named():
    done = run('--', 'no-such-command')
    assert done.returncode == 127
    assert done.stderr.splitlines()[-1] == (
        'course: no-such-command does not start: No such file or directory'
    )


@pytest.fixture
def home(tmp_path):
    """A home folder whose ~/.bashrc sets up another ROS, as those of many students do."""
    (tmp_path / '.bashrc').write_text(
        'export ROS_DOMAIN_ID=42 ROS_DISTRO=humble PYTHONPATH=/opt/ros/humble/python\n'
        'export PATH=/opt/ros/humble/bin:$PATH AMENT_PREFIX_PATH=/opt/ros/humble\n'
        'alias mine="echo my alias"\n'
        'PS1="READY "\n'
    )
    return tmp_path


def test_an_interactive_shell_has_the_users_aliases_and_the_courses_settings(home):
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
