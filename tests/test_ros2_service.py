"""What `ros2 service` prints of a running system: the cases of ros2cli's own tests (Jazzy)."""

import re
import signal

import pytest
from ros2_command import SCRIPT, TIMEOUT_SEC, on_the_graph, own_domain, ros2, started

BUILT_IN = {
    'describe_parameters': 'rcl_interfaces/srv/DescribeParameters',
    'get_parameter_types': 'rcl_interfaces/srv/GetParameterTypes',
    'get_parameters': 'rcl_interfaces/srv/GetParameters',
    'get_type_description': 'type_description_interfaces/srv/GetTypeDescription',
    'list_parameters': 'rcl_interfaces/srv/ListParameters',
    'set_parameters': 'rcl_interfaces/srv/SetParameters',
    'set_parameters_atomically': 'rcl_interfaces/srv/SetParametersAtomically',
}
ECHO, HIDDEN = '/my_ns/echo', '/my_ns/_echo'
WAITING = 'waiting for service to become available...\n'


@pytest.fixture(scope='module', autouse=True)
def system():
    with own_domain(), on_the_graph('services', topics=('/my_ns/_echo_is_up',)):
        yield


def lines(*names):
    return ''.join(f'{name}\n' for name in names)


def built_in(node_name):
    return [f'{node_name}/{service}' for service in BUILT_IN]


def exchange(data):
    return (
        f'requester: making request: std_srvs.srv.SetBool_Request(data={data})\n\nresponse:\n'
        f"std_srvs.srv.SetBool_Response(success={data}, message='got {data}')\n\n"
    )


ALL = lines(
    *(HIDDEN, *built_in('/my_ns/_hidden_echo_server'), ECHO, *built_in('/my_ns/echo_server'))
)
TYPED = lines(
    f'{ECHO} [std_srvs/srv/SetBool]',
    *(f'/my_ns/echo_server/{name} [{type_name}]' for name, type_name in BUILT_IN.items()),
)
INFO = 'Type: std_srvs/srv/SetBool\nClients count: 0\nServices count: 1\n'
SHOWN = [
    ('list', lines(ECHO, *built_in('/my_ns/echo_server'))),
    ('list -t', TYPED),
    ('list -c', '8\n'),
    ('list -t -c', '8\n'),
    ('find std_srvs/SetBool', ''),
    ('find -c not_a_service_type', '0\n'),
    (
        'type /my_ns/echo_server/get_type_description',
        'type_description_interfaces/srv/GetTypeDescription\n',
    ),
    ('find std_srvs/srv/SetBool', lines(ECHO)),
    ('find --include-hidden-services std_srvs/srv/SetBool', lines(HIDDEN, ECHO)),
    ('find -c std_srvs/srv/SetBool', '1\n'),
    ('find not_a_service_type', ''),
    ('type /my_ns/echo', 'std_srvs/srv/SetBool\n'),
    ('--include-hidden-services type /my_ns/_echo', 'std_srvs/srv/SetBool\n'),
    ('info /my_ns/echo', INFO),
    ('--include-hidden-services info /my_ns/_echo', INFO),
]


@pytest.mark.parametrize(('words', 'expected'), SHOWN, ids=[words for words, _ in SHOWN])
def test_service_verbs_print_the_output_of_ros2cli(words, expected):
    result = ros2('service', *words.split())
    assert (result.out, result.err, result.status) == (expected, '', 0)


def test_hidden_services_are_listed_on_request():
    listed = ros2('service', 'list', '--include-hidden-services')
    own = r'/_ros2cli_\d+/get_type_description\n'  # as ros2cli's own node has it
    assert re.sub(own, '', listed.out) == ALL
    assert listed.status == 0


CALLS = [
    (('std_srvs/srv/SetBool',), '', False),
    (('std_srvs/srv/SetBool', '{data: true}'), '', True),
    (('std_srvs/SetBool', 'data: 1'), '', True),
    (('std_srvs/srv/SetBool', '--stdin'), 'data: true', True),
]


@pytest.mark.parametrize(('words', 'stdin', 'data'), CALLS, ids=[str(call[0]) for call in CALLS])
def test_a_call_shows_request_and_response(words, stdin, data):
    result = ros2('service', 'call', ECHO, *words, stdin=stdin)
    assert (result.out.removeprefix(WAITING), result.err) == (exchange(data), '')
    assert result.status == 0


PARAMETER = (
    '{name: a, value: {type: 3, integer_value: -1, double_value: 0.1, string_value: bazbar}}'
)
VALUE = (
    'rcl_interfaces.msg.ParameterValue(type=3, bool_value=False, integer_value=-1, '
    "double_value=0.1, string_value='bazbar', byte_array_value=[], bool_array_value=[], "
    'integer_array_value=[], double_array_value=[], string_array_value=[])'
)


def test_a_call_takes_values_of_every_kind():
    service = '/my_ns/echo_server/set_parameters', 'rcl_interfaces/srv/SetParameters'
    result = ros2('service', 'call', *service, f'{{parameters: [{PARAMETER}]}}')
    assert result.out.removeprefix(WAITING) == (
        'requester: making request: rcl_interfaces.srv.SetParameters_Request(parameters='
        f"[rcl_interfaces.msg.Parameter(name='a', value={VALUE})])\n\n"
        'response:\nrcl_interfaces.srv.SetParameters_Response(results=['
        'rcl_interfaces.msg.SetParametersResult(successful=False, '
        "reason='Invalid access to undeclared parameter(s): []')])\n\n"
    )
    assert (result.err, result.status) == ('', 0)


def test_a_repeated_call_goes_on_until_a_signal():
    call = 'service', 'call', '-r', '5', ECHO, 'std_srvs/srv/SetBool', '{data: true}'
    with started(SCRIPT, *call) as process:
        text = ''
        while text.removeprefix(WAITING) != 2 * exchange(True):
            line = process.stdout.readline()
            assert line, text
            text += line
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (err, process.returncode) == ('', signal.SIGINT)


def test_sigterm_ends_the_wait_for_a_service():
    with started(SCRIPT, 'service', 'call', '/nothing', 'std_srvs/srv/Empty') as process:
        assert process.stdout.readline() == WAITING
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (out, err, process.returncode) == ('', '', signal.SIGTERM)


INVALID = 'The passed service type is invalid'
REFUSED = [
    ('type /not_a_service', '', 1),
    ('type /my_ns/_echo', '', 1),
    ('type my_ns/echo', '', 1),
    ('info my_ns/echo', "Unknown service 'my_ns/echo'\n", 1),
    ('info /not_a_service', "Unknown service '/not_a_service'\n", 1),
    ('info /my_ns/_echo', "Unknown service '/my_ns/_echo'\n", 1),
    ('call /x os/path', f'{INVALID}\n', 1),
    ('call /x nothing', f'{INVALID}\n', 1),
    ('call /x std_srvs/srv/Setbool', f'{INVALID}: did you mean std_srvs/srv/SetBool?\n', 1),
    ('call /x std_msgs/msg/String', 'The passed type is not a service\n', 1),
    ('call /x std_srvs/SetBool [1]', 'Failed to populate field: '
     "Value '[1]' is expected to be a dictionary but is a list\n", 1),
    ('call /x std_srvs/SetBool 3', 'Failed to populate field: '
     "Value '3' is expected to be a dictionary but is a int\n", 1),
    ('call /x a/b/c/d', f'{INVALID}\n', 1),
    ('call /x std_srvs/SetBool -r -1', 'rate must be greater than zero\n', 1),
    ('call /x std_srvs/SetBool {data:[}', 'The passed value is not YAML: '
     'while parsing a flow node\n'
     "expected the node content, but found '}'\n"
     '  in "<unicode string>", line 1, column 8:\n    {data:[}\n           ^\n', 1),
    ('call /x std_srvs/SetBool {date:}', 'Failed to populate field: '
     "date: std_srvs/srv/SetBool_Request has no field 'date': did you mean data?\n", 1),
    ('call /x std_srvs/SetBool -r 0', 'rate must be greater than zero\n', 1),
    ('call /x std_srvs/SetBool -r nan', 'rate must be greater than zero\n', 1),
    ('call //x std_srvs/SetBool', "Invalid service name: topic name must not contain repeated "
     "'/':\n  '//x'\n    ^\n", 1),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'complaint', 'status'), REFUSED, ids=[r[0] for r in REFUSED])
def test_invalid_service_arguments_are_refused_as_by_ros2cli(words, complaint, status):
    result = ros2('service', *words.split())
    assert (result.out, result.err, result.status) == ('', complaint, status)


@pytest.mark.parametrize('words', ['call /x', 'call /x std_srvs/SetBool -r x', 'find', 'info'])
def test_wrong_usage_of_a_service_verb_prints_its_correct_usage(words):
    result = ros2('service', *words.split())
    assert result.err.startswith(f'usage: ros2 service {words.split()[0]} [-h]')
    assert (result.out, result.status) == ('', 2)
