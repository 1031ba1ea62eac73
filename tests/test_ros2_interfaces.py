"""`ros2 interface`: every definition that is installed, as ros2cli shows it."""

import pytest
from my_robot_basics.ros2 import interfaces, main, stopping
from ros2_command import ros2


def test_interfaces_are_listed_as_ros2cli_lists_them():
    everything = ros2('interface', 'list').out
    titles = [line for line in everything.splitlines() if not line.startswith('    ')]
    assert titles == ['Messages:', 'Services:', 'Actions:']
    assert '    sensor_msgs/msg/JointState\n' in everything
    assert '_Event' not in everything
    messages = ros2('interface', 'list', '-m').out
    assert everything.startswith(messages)
    names = messages.splitlines()[1:]
    assert names == sorted(names)
    both = ros2('interface', 'list', '--only-actions', '-s').out.splitlines()
    assert both[0] == 'Services:'
    assert '    std_srvs/srv/Trigger' in both
    assert 'Actions:' in both


SHOWN = {
    'geometry_msgs/msg/PointStamped': (
        '# This represents a Point with reference coordinate frame and timestamp\n\n'
        'std_msgs/Header header\n\tbuiltin_interfaces/Time stamp\n\t\tint32 sec\n'
        '\t\tuint32 nanosec\n\tstring frame_id\nPoint point\n\tfloat64 x\n\tfloat64 y\n'
        '\tfloat64 z\n'
    ),
    'std_srvs/srv/SetBool': (
        'bool data # e.g. for hardware enabling / disabling\n---\n'
        'bool success   # indicate successful run of triggered service\n'
        'string message # informational, e.g. for error messages\n'
    ),
}


@pytest.mark.parametrize('name', SHOWN)
def test_interfaces_are_shown_with_what_they_hold(name):
    result = ros2('interface', 'show', name)
    assert (result.out, result.err, result.status) == (SHOWN[name], '', 0)
    assert ros2('interface', 'show', '-', stdin=f'{name}\n').out == SHOWN[name]


def test_comments_are_shown_on_request():
    name = 'geometry_msgs/msg/PointStamped'
    assert ros2('interface', 'show', name, '--no-comments').out == SHOWN[name].partition('\n\n')[2]
    with_all = ros2('interface', 'show', '--all-comments', name).out
    assert '\t\t# The seconds component, valid over all int32 values.\n' in with_all


@pytest.mark.parametrize('name', interfaces.names('msg') + interfaces.names('srv'))
def test_every_interface_can_be_shown(name, capsys, monkeypatch):
    monkeypatch.setattr(stopping, 'watch', lambda: None)
    assert main.main(['interface', 'show', name]) is None
    assert capsys.readouterr().err == ''


@pytest.mark.parametrize(
    ('name', 'complaint'),
    [
        ('String', "Invalid name 'String'. Expected three parts separated by '/'\n"),
        ('a/String', "Invalid name 'a/String'. Expected three parts separated by '/'\n"),
        ('std_msgs//String', "Invalid name 'std_msgs//String'. Must not contain empty parts\n"),
        ('no_msgs/msg/String', "Unknown package 'no_msgs'\n"),
        ('std_msgs/msg/Strin', "Could not find the interface '"),
    ],
)  # fmt: skip
def test_an_unknown_interface_is_named(name, complaint):
    result = ros2('interface', 'show', name)
    assert result.err.startswith(complaint)
    assert result.status == 1
