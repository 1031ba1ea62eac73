"""What `ros2` prints of a running system, held to ros2cli's documented output (Jazzy)."""

import re

import pytest
from ros2_command import on_the_graph, own_domain, ros2

TYPE_HASH = 'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18'  # String
GET = 'rcl_interfaces/srv/GetParameters'


@pytest.fixture(scope='module', autouse=True)
def system():
    topics = '/everything_is_up', '/kinematics/joint_states', '/_other_type_is_up'
    nodes = 'everything', 'five_hz', 'other_type'
    with own_domain(), on_the_graph(*nodes, topics=topics):
        yield


def lines(text):
    return text.strip('\n').split('\n')


TOPICS = """
/arm_description
/everything_is_up
/heard
/kinematics/joint_states
/parameter_events
/rosout
/two_types
"""

TYPED_TOPICS = """
/arm_description [std_msgs/msg/String]
/everything_is_up [std_msgs/msg/String]
/heard [std_msgs/msg/String]
/kinematics/joint_states [sensor_msgs/msg/JointState]
/parameter_events [rcl_interfaces/msg/ParameterEvent]
/rosout [rcl_interfaces/msg/Log]
/two_types [std_msgs/msg/Int32, std_msgs/msg/String]
"""

# the command's own node counts, as ros2cli's daemon does
VERBOSE_TOPICS = """
Published topics:
 * /arm_description [std_msgs/msg/String] 1 publisher
 * /everything_is_up [std_msgs/msg/String] 1 publisher
 * /kinematics/joint_states [sensor_msgs/msg/JointState] 1 publisher
 * /parameter_events [rcl_interfaces/msg/ParameterEvent] 4 publishers
 * /rosout [rcl_interfaces/msg/Log] 4 publishers
 * /two_types [std_msgs/msg/Int32, std_msgs/msg/String] 2 publishers

Subscribed topics:
 * /heard [std_msgs/msg/String] 1 subscriber

"""

INFO = """
Type: sensor_msgs/msg/JointState
Publisher count: 1
Subscription count: 0
"""

VERBOSE_INFO = rf"""
Type: std_msgs/msg/String

Publisher count: 1

Node name: everything
Node namespace: /arm
Topic type: std_msgs/msg/String
Topic type hash: {TYPE_HASH}
Endpoint type: PUBLISHER
GID: [0-9a-f]{{2}}(\.[0-9a-f]{{2}}){{15}}
QoS profile:
  Reliability: RELIABLE
  History \(Depth\): UNKNOWN
  Durability: TRANSIENT_LOCAL
  Lifespan: Infinite
  Deadline: Infinite
  Liveliness: AUTOMATIC
  Liveliness lease duration: Infinite

Subscription count: 0

"""

SERVICES = """
/arm/everything/describe_parameters
/arm/everything/get_parameter_types
/arm/everything/get_parameters
/arm/everything/get_type_description
/arm/everything/list_parameters
/arm/everything/set_parameters
/arm/everything/set_parameters_atomically
/arm/start
/kinematics_publisher/describe_parameters
/kinematics_publisher/get_parameter_types
/kinematics_publisher/get_parameters
/kinematics_publisher/get_type_description
/kinematics_publisher/list_parameters
/kinematics_publisher/set_parameters
/kinematics_publisher/set_parameters_atomically
/other_type/get_type_description
"""

HIDDEN_TOPICS = """
/_hidden
/_other_type_is_up
/arm/move/_action/feedback
/arm/move/_action/status
""".strip()

NODE_INFO = """
/arm/everything
  Subscribers:
    /heard: std_msgs/msg/String
  Publishers:
    /arm_description: std_msgs/msg/String
    /everything_is_up: std_msgs/msg/String
    /parameter_events: rcl_interfaces/msg/ParameterEvent
    /rosout: rcl_interfaces/msg/Log
    /two_types: std_msgs/msg/String
  Service Servers:
    /arm/everything/describe_parameters: rcl_interfaces/srv/DescribeParameters
    /arm/everything/get_parameter_types: rcl_interfaces/srv/GetParameterTypes
    /arm/everything/get_parameters: rcl_interfaces/srv/GetParameters
    /arm/everything/get_type_description: type_description_interfaces/srv/GetTypeDescription
    /arm/everything/list_parameters: rcl_interfaces/srv/ListParameters
    /arm/everything/set_parameters: rcl_interfaces/srv/SetParameters
    /arm/everything/set_parameters_atomically: rcl_interfaces/srv/SetParametersAtomically
    /arm/start: std_srvs/srv/Trigger
  Service Clients:
    /arm/start: std_srvs/srv/Trigger
  Action Servers:
    /arm/move: arm_interfaces/action/MoveArm
  Action Clients:

"""

PARAMETERS = """
  a_bool (type: boolean)
  a_double (type: double)
  a_string (type: string)
  an_integer (type: integer)
  some_bools (type: boolean array)
  some_bytes (type: byte array)
  some_doubles (type: double array)
  some_integers (type: integer array)
  some_strings (type: string array)
  start_type_description_service (type: boolean)
  use_sim_time (type: boolean)
"""

ALL_PARAMETERS = """
/arm/everything:
  a_bool
  a_double
  a_string
/kinematics_publisher:
  use_sim_time
Wait for service timed out waiting for parameter services for node /other_type
"""

SHOWN = [
    ('topic list', TOPICS),
    ('topic list --show-types', TYPED_TOPICS),
    ('topic list -v', VERBOSE_TOPICS),
    ('topic list -c', '7\n'),
    ('topic list --include-hidden-topics', HIDDEN_TOPICS + TOPICS),
    ('topic --include-hidden-topics list -c', '11\n'),
    ('topic list --no-daemon --spin-time 1.5', TOPICS),
    ('topic info /kinematics/joint_states', INFO),
    ('topic info /two_types', "Type: ['std_msgs/msg/Int32', 'std_msgs/msg/String']\n"
     'Publisher count: 2\nSubscription count: 0\n'),
    ('topic type /two_types', 'std_msgs/msg/Int32\nstd_msgs/msg/String\n'),
    ('topic find sensor_msgs/msg/JointState', '/kinematics/joint_states\n'),
    ('topic find std_msgs/msg/String --include-hidden-topics -c', '5\n'),
    ('topic find std_msgs/msg/Nothing', ''),
    ('node list', '/arm/everything\n/kinematics_publisher\n/other_type\n'),
    ('node list -c', '3\n'),
    ('node info /arm/everything', NODE_INFO),
    ('service list', SERVICES),
    ('service list -c', '16\n'),
    ('service type /arm/start', 'std_srvs/srv/Trigger\n'),
    ('param list arm/everything --param-type', PARAMETERS),
    ('param list --filter (a_[bds]|use_sim)', ALL_PARAMETERS.replace(
        '  a_string\n', '  a_string\n  use_sim_time\n')),
    ('param get /arm/everything a_bool', 'Boolean value is: True\n'),
    ('param get /arm/everything an_integer', 'Integer value is: 3\n'),
    ('param get /arm/everything a_double', 'Double value is: 0.5\n'),
    ('param get arm/everything a_string', 'String value is: text\n'),
    ('param get /arm/everything some_bytes', "Byte values are: [b'a', b'b']\n"),
    ('param get /arm/everything some_bools', 'Boolean values are: [True, False]\n'),
    ('param get /arm/everything some_integers', 'Integer values are: [1, 2]\n'),
    ('param get /arm/everything some_doubles', 'Double values are: [0.5, 1.5]\n'),
    ('param get /arm/everything some_strings', "String values are: ['a', 'b']\n"),
    ('param get /arm/everything some_strings --hide-type', "['a', 'b']\n"),
    ('param set /arm/everything an_integer 4', 'Set parameter successful\n'),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'expected'), SHOWN, ids=[words for words, _ in SHOWN])
def test_graph_verbs_print_the_output_of_ros2cli(words, expected):
    result = ros2(*words.split())
    expected = expected.removeprefix('\n') if expected.count('\n') > 1 else expected
    assert (result.out, result.err, result.status) == (expected, '', 0)


def test_verbose_topic_info_has_the_format_of_ros2cli():
    result = ros2('topic', 'info', '/arm_description', '--verbose')
    assert re.fullmatch(VERBOSE_INFO.removeprefix('\n'), result.out), result.out


def test_hidden_nodes_are_listed_on_request():
    own, *others = ros2('node', 'list', '--all').out.splitlines()
    assert re.fullmatch(r'/_ros2cli_\d+', own)
    assert others == ['/arm/everything', '/kinematics_publisher', '/other_type']


REFUSED = [
    ('topic info /nothing', "Unknown topic '/nothing'\n", 1),
    ('topic info kinematics/joint_states', "Unknown topic 'kinematics/joint_states'\n", 1),
    ('topic type /nothing', '', 1),
    ('topic type /_hidden', '', 1),
    ('node info /nobody', "Unable to find node '/nobody'\n", 1),
    ('service type /nothing', '', 1),
    ('param list /nobody', 'Node not found\n', 1),
    ('param get /nobody a_bool --timeout 0', 'Node not found\n', 1),
    ('param get /arm/everything nothing', 'Parameter not set\n', 1),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'complaint', 'status'), REFUSED, ids=[r[0] for r in REFUSED])
def test_unknown_names_are_refused_as_by_ros2cli(words, complaint, status):
    result = ros2(*words.split())
    assert (result.err, result.status) == (complaint, status)


@pytest.mark.slow
def test_a_parameter_value_of_another_type_is_refused_by_the_node():
    result = ros2('param', 'set', '/arm/everything', 'an_integer', 'text')
    assert result.err.startswith('Setting parameter failed: ')
    assert result.status == 0  # as ros2cli
