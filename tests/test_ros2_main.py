"""The `ros2` command as a whole: what it leaves to ros2cli, offers and refuses."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pexpect
import pytest
from my_robot_basics.ros2 import arguments, environment, main, stopping
from my_robot_basics.ros2.table import COMMANDS, ELSEWHERE
from my_robot_basics.session import lessons
from ros2_command import SCRIPT, ros2

REAL = """
import os, sys

def main(*, script_name='ros2', argv=None, description=None, extension=None):
    print(sys.argv[1:], argv, os.environ.get('ROS_DOMAIN_ID'))
    return 7
"""
VERBS = [(c, verb) for c, command in COMMANDS.items() for verb in command.verbs or ('',)]


def test_a_real_ros2cli_receives_all_arguments_unchanged(tmp_path):
    package = tmp_path / 'ros2cli'
    package.mkdir()
    (package / '__init__.py').touch()
    (package / 'cli.py').write_text(REAL)
    result = ros2('topic', 'delay', '-h', PYTHONPATH=str(tmp_path), ROS_DOMAIN_ID='')
    assert (result.out, result.err, result.status) == ("['topic', 'delay', '-h'] None \n", '', 7)


@pytest.mark.parametrize(
    ('words', 'name'),
    [
        *(((command, 'list'), f'`ros2 {command}`') for command in ELSEWHERE),
        *(
            ((name, verb, '-x'), f'`ros2 {name} {verb}` ')
            for name, command in COMMANDS.items()
            for verb in command.elsewhere
        ),
        (('topic', '--include-hidden-topics', 'delay', '/x'), '`ros2 topic delay` '),
    ],
)
def test_a_ros2cli_command_that_the_course_lacks_is_named_with_its_package(
    words, name, capsys, monkeypatch
):
    monkeypatch.setattr(stopping, 'set_handlers', lambda: None)
    assert main.main(list(words)) == 2
    printed = capsys.readouterr()
    assert printed.out == ''
    assert printed.err.startswith(f'{name.strip()} is not part of this course: ')
    assert f'the package ros2{words[0]} of ros2cli' in printed.err


@pytest.mark.parametrize('words', [['nothing'], ['topic', 'nothing'], ['topic', 'list', '-y']])
def test_an_unknown_command_verb_or_option_is_a_usage_error(words):
    result = ros2(*words)
    assert (result.out, result.status) == ('', 2)
    assert 'Traceback' not in result.err
    assert result.err.splitlines()[-1].startswith('ros2')


def test_a_command_without_a_verb_lists_the_verbs():
    result = ros2('topic')
    assert '  hz    Print the average publishing rate to screen\n' in result.out
    assert result.status == 0
    result = ros2()
    assert '  topic      Various topic related sub-commands\n' in result.out
    assert result.status == 0


@pytest.mark.parametrize('words', VERBS)
def test_every_verb_has_help(words, capsys):
    words = [word for word in words if word]
    with pytest.raises(SystemExit) as ended:
        main.make_parser(words).parse_args([*words, '--help'])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith(f'usage: ros2 {" ".join(words)} [-h]')


def test_the_table_of_verbs_matches_the_files_of_verbs():
    folder = Path(main.__file__).parent / 'verbs'
    files = {path.stem for path in folder.glob('*.py')} - {'__init__'}
    assert files == {f'{command}_{verb}'.rstrip('_') for command, verb in VERBS}


def test_qos_profiles_and_policies_have_the_choices_of_rclpy():
    import rclpy.qos

    assert list(arguments.PROFILES) == rclpy.qos.QoSPresetProfiles.short_keys()
    for name, choices in arguments.POLICIES.items():
        policy = getattr(rclpy.qos, f'QoS{name.capitalize()}Policy')
        assert set(choices) == set(policy.short_keys())


@pytest.mark.parametrize('text', ['x', '233', '-1', '²', '1.5'])
def test_an_invalid_domain_id_is_reported(text):
    result = ros2('topic', 'list', ROS_DOMAIN_ID=text)
    assert result.err == (
        f'ROS_DOMAIN_ID is {text!r}, expected a number from 0 to 232: correct it, or unset it\n'
    )
    assert result.status == 1


def test_settings_in_the_environment_are_kept(monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', '5')
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    monkeypatch.setenv('FASTRTPS_DEFAULT_PROFILES_FILE', '/mine.xml')
    monkeypatch.setenv('AMENT_PREFIX_PATH', '/workspace/install')
    environment.enter()
    environment.enter()
    assert environment.domain_id() == 5
    assert not environment.is_localhost_only()
    assert os.environ['FASTRTPS_DEFAULT_PROFILES_FILE'] == '/mine.xml'
    assert os.environ['AMENT_PREFIX_PATH'] == f'/workspace/install:{sys.prefix}'


def test_a_shell_without_settings_gets_those_of_a_lesson(monkeypatch):
    monkeypatch.setattr(lessons, 'running', list)
    for name in ('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'AMENT_PREFIX_PATH'):
        monkeypatch.setenv(name, '')
    monkeypatch.delenv('FASTRTPS_DEFAULT_PROFILES_FILE')
    environment.enter()
    assert environment.domain_id() == 0
    assert environment.is_localhost_only()
    assert Path(os.environ['FASTRTPS_DEFAULT_PROFILES_FILE']).is_file()
    assert os.environ['AMENT_PREFIX_PATH'] == sys.prefix


def test_a_closed_stdout_is_not_an_error():
    shell = pexpect.run(f'bash -c \'"{SCRIPT}" interface list >&-; echo $?\'', encoding='utf-8')
    assert shell == '0\r\n'


def test_interface_show_does_not_import_rclpy():
    light = ['interface', 'show', 'std_msgs/msg/String']
    code = f'import sys; sys.argv[1:] = {light}; from my_robot_basics.ros2 import main;'
    code += "main.main(); sys.exit('rclpy' in sys.modules)"
    assert pexpect.run(f'{sys.executable} -c "{code}"', withexitstatus=True)[1] == 0


def test_topic_list_does_not_import_the_generator_of_message_modules():
    code = "import sys; sys.argv[1:] = ['topic', 'list']; from my_robot_basics.ros2 import main;"
    code += "main.main(); sys.exit('rclpy' not in sys.modules or 'lark' in sys.modules)"
    assert pexpect.run(f'{sys.executable} -c "{code}"', withexitstatus=True)[1] == 0


def test_a_slow_exit_of_python_does_not_change_the_exit_status():
    # the alarm would kill it there, where Python has taken our handler away
    code = """
import atexit, os, signal, sys
from my_robot_basics.ros2 import main, stopping
from my_robot_basics.ros2.verbs import interface_list
def stop(args):
    stopping.only_record_signals()
    os.kill(os.getpid(), signal.SIGINT)
    stopping.check()
interface_list.main = stop
atexit.register(lambda: print(signal.getitimer(signal.ITIMER_REAL)))
sys.exit(main.main(['interface', 'list']))
"""
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, encoding='utf-8')
    assert (done.stdout, done.stderr) == ('(0.0, 0.0)\n', '')
    assert done.returncode == signal.SIGINT
