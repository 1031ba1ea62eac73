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
def test_interfaces_are_shown_with_their_fields(name):
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
    monkeypatch.setattr(stopping, 'set_handlers', lambda: None)
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


# --- by package ----------------------------------------------------------------------------------


def test_packages_are_listed_as_ros2cli_lists_them():
    everything = ros2('interface', 'packages').out.splitlines()
    assert everything == sorted(everything)
    assert {'arm_interfaces', 'sensor_msgs', 'std_srvs'} <= set(everything)
    assert ros2('interface', 'packages', '-a').out == 'arm_interfaces\n'
    services = ros2('interface', 'packages', '--only-srvs').out.splitlines()
    assert 'std_srvs' in services
    assert 'geometry_msgs' not in services
    # of several options, ros2cli takes the first one
    both = ros2('interface', 'packages', '-a', '-m').out
    assert both == ros2('interface', 'packages', '-m').out != 'arm_interfaces\n'


def test_a_package_shows_its_types_as_ros2cli_does():
    both = 'action/MoveArm', 'srv/SolveIK'
    lines = [f'arm_interfaces/{name}\n' for name in both]
    assert ros2('interface', 'package', 'arm_interfaces').out == ''.join(lines)
    assert ros2('interface', 'package', 'arm_interfaces', '-s').out == lines[1]
    # with options, by kind
    assert ros2('interface', 'package', '-a', '-s', 'arm_interfaces').out == ''.join(lines[::-1])
    assert ros2('interface', 'package', '-m', 'arm_interfaces').out == ''
    assert ros2('interface', 'package', 'rclpy').out == ''


@pytest.mark.parametrize('name', ['no_msgs', '../std_msgs', 'std_msgs/msg'])
def test_an_unknown_package_is_named(name):
    result = ros2('interface', 'package', name)
    assert (result.out, result.err) == ('', f"Unknown package '{name}'\n")
    assert result.status == 1


# --- prototypes ----------------------------------------------------------------------------------

PROTOTYPES = {
    'std_msgs/msg/String': "data: ''\n",
    'std_srvs/srv/SetBool': 'data: false\n',
    'arm_interfaces/action/MoveArm': 'position: []\nspeed: 0.0\n',
    'geometry_msgs/msg/Quaternion': 'x: 0.0\ny: 0.0\nz: 0.0\nw: 1.0\n',
}


@pytest.mark.parametrize('name', PROTOTYPES)
def test_a_prototype_shows_the_fields_that_a_client_sends(name):
    assert ros2('interface', 'proto', name, '--no-quotes').out == f'{PROTOTYPES[name]}\n'
    assert ros2('interface', 'proto', name).out == f'"{PROTOTYPES[name]}"\n'


@pytest.mark.parametrize('name', ['std_msgs', 'std_msgs/msg/Strin', 'os/srv/path', 'a/action/B'])
def test_a_prototype_of_an_invalid_type_is_refused(name):
    result = ros2('interface', 'proto', name)
    assert result.out == ''
    assert result.err.startswith('The passed ')
    assert result.status == 1
