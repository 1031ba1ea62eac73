"""What `ros2 param` prints of a running system: the cases of ros2cli's own tests (Jazzy)."""

import pytest
import yaml
from ros2_command import on_the_graph, own_domain, ros2

DUMPED = """\
/foo/test_node:
  ros__parameters:
    bool_array_param:
    - false
    - false
    - true
    bool_param: true
    double_array_param:
    - 3.125
    - 6.25
    - 12.5
    double_param: 1.23
    foo:
      bar:
        str_param: foobar
      str_param: foo
    int_array_param:
    - 1
    - 2
    - 3
    int_param: 42
    start_type_description_service: true
    str_array_param:
    - foo
    - bar
    - baz
    str_param: Hello World
    use_sim_time: false
"""
OTHERS = """\
/foo/test_node:
  ros__parameters:
    bool_array_param:
    - true
    - false
    - false
    bool_param: false
    double_array_param:
    - 2.125
    - 1.25
    - 2.5
    double_param: 1.3
    foo:
      bar:
        str_param: foo_bar
      str_param: foobar
    int_array_param:
    - 42
    - 3
    - 3
    int_param: -42
    str_array_param:
    - a_foo
    - a_bar
    - a_baz
    str_param: Bye World
"""
WILDCARD = '/**:\n  ros__parameters:\n    int_param: 12345\n    str_param: Wildcard\n'
OVERLAY = '/foo/test_node:\n  ros__parameters:\n    str_param: Override\n'
NAMES = [
    *('bool_array_param', 'bool_param', 'double_array_param', 'double_param'),
    *('foo.bar.str_param', 'foo.str_param', 'int_array_param', 'int_param'),
    *('start_type_description_service', 'str_array_param', 'str_param', 'use_sim_time'),
]


@pytest.fixture(scope='module', autouse=True)
def system():
    topics = '/_test_node_is_up', '/_constrained_is_up'
    with own_domain(), on_the_graph('parameters', topics=topics):
        yield


@pytest.fixture
def load(tmp_path):
    def load(text, *words):
        path = tmp_path / 'params.yaml'
        path.write_text(text)
        return ros2('param', 'load', '/foo/test_node', str(path), *words)

    yield load
    load(DUMPED)


def values():
    dumped = yaml.safe_load(ros2('param', 'dump', '/foo/test_node').out)
    return dumped['/foo/test_node']['ros__parameters']


DESCRIBED = {
    'rate_hz': """\
Parameter name: rate_hz
  Type: double
  Description: Messages a second
  Constraints:
    Min value: 1.0
    Max value: 50.0
""",
    'seed': """\
Parameter name: seed
  Type: integer
  Constraints:
    Min value: 0
    Max value: 100
    Step: 5
    Additional constraints: not 13
""",
    'robot': """\
Parameter name: robot
  Type: string
  Constraints:
    Read only: true
""",
}
SHOWN = [
    ('list /foo/test_node', ''.join(f'  {name}\n' for name in NAMES)),
    ('list /foo/test_node --filter bool.*', '  bool_array_param\n  bool_param\n'),
    ('list /foo/test_node --param-prefixes foo.bar', '  foo.bar.str_param\n'),
    ('list foo/test_node --param-prefixes foo --param-type',
     '  foo.bar.str_param (type: string)\n  foo.str_param (type: string)\n'),
    ('get /foo/test_node foo.bar.str_param', 'String value is: foobar\n'),
    ('dump /foo/test_node', f'{DUMPED}\n'),
    ('dump foo/test_node --timeout 3', f'{DUMPED}\n'),
    ('dump /foo/without_value', '/foo/without_value:\n  ros__parameters: {}\n\n'),
    ('describe /foo/constrained rate_hz', DESCRIBED['rate_hz']),
    ('describe foo/constrained seed robot', DESCRIBED['seed'] + DESCRIBED['robot']),
    ('describe /foo/constrained nothing', ''),
    ('describe /foo/constrained seed nothing robot', ''),
    ('set /foo/constrained rate_hz 7.5', 'Set parameter successful\n'),
    ('set /foo/constrained any text', 'Set parameter successful\n'),
    ('delete /foo/constrained any', 'Deleted parameter successfully\n'),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'expected'), SHOWN, ids=[words for words, _ in SHOWN])
def test_param_verbs_print_the_output_of_ros2cli(words, expected):
    result = ros2('param', *words.split())
    assert (result.out, result.err, result.status) == (expected, '', 0)


READ_ONLY = 'Trying to set a read-only parameter: robot.'
UNDECLARED = 'Invalid access to undeclared parameter(s): []'
OUT_OF_RANGE = 'Parameter rate_hz out of range Min: 1.0, Max: 50.0, value: 0.5'
WRONG_TYPE = "Wrong parameter type, expected 'Type.DOUBLE' got 'Type.INTEGER'"
REFUSED_BY_THE_NODE = [
    ('set /foo/constrained even 3', 'Setting parameter failed: even must be even, got 3\n'),
    ('set /foo/constrained robot other', f'Setting parameter failed: {READ_ONLY}\n'),
    ('set /foo/constrained nothing 1', f'Setting parameter failed: {UNDECLARED}\n'),
    ('set /foo/constrained rate_hz 0.5', f'Setting parameter failed: {OUT_OF_RANGE}\n'),
    ('set /foo/constrained rate_hz 7', f'Setting parameter failed: {WRONG_TYPE}\n'),
    ('delete /foo/constrained robot', f'Deleting parameter failed: {READ_ONLY}\n'),
    ('delete /foo/constrained nothing', f'Deleting parameter failed: {UNDECLARED}\n'),
    ('delete /foo/constrained even',
     'Deleting parameter failed: Static parameter cannot be undeclared\n'),
]  # fmt: skip


@pytest.mark.parametrize(
    ('words', 'complaint'), REFUSED_BY_THE_NODE, ids=[r[0] for r in REFUSED_BY_THE_NODE]
)
def test_a_refusal_by_the_node_is_printed_with_its_reason(words, complaint):
    result = ros2('param', *words.split())
    assert (result.out, result.err, result.status) == ('', complaint, 0)  # as ros2cli


REFUSED = [
    ('list invalid_node', 'Node not found\n'),
    ('list invalid_ns/test_node', 'Node not found\n'),
    ('dump invalid_node --timeout 0', 'Node not found\n'),
    ('dump invalid_ns/test_node --timeout 0', 'Node not found\n'),
    ('describe invalid_node x --timeout 0', 'Node not found\n'),
    ('delete invalid_node x --timeout 0', 'Node not found\n'),
    ('load invalid_node invalid_path --timeout 0', 'Node not found\n'),
    ('load /foo/test_node invalid_path',
     "[Errno 2] No such file or directory: 'invalid_path'\n"),
    ('get /foo/test_node nothing', 'Parameter not set\n'),
    ('dump /foo/tangled', "YAML can't have the parameter 'arm.speed': "
     "'arm' is a parameter with a value\n"),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'complaint'), REFUSED, ids=[r[0] for r in REFUSED])
def test_unknown_nodes_files_and_parameters_are_refused_as_by_ros2cli(words, complaint):
    result = ros2('param', *words.split())
    assert (result.out, result.err, result.status) == ('', complaint, 1)


@pytest.mark.parametrize(
    ('words', 'missing'),
    [
        ('load', 'node_name, parameter_file'),
        ('load some_node', 'parameter_file'),
        ('describe some_node', 'parameter_names'),
        ('delete some_node', 'parameter_name'),
        ('dump', 'node_name'),
    ],
)
def test_missing_arguments_are_named(words, missing):
    result = ros2('param', *words.split())
    verb = words.split()[0]
    complaint = f'ros2 param {verb}: error: the following arguments are required: {missing}\n'
    assert result.err.endswith(complaint)
    assert (result.out, result.status) == ('', 2)


def test_loaded_parameters_are_dumped_with_the_same_values(load):
    result = load(OTHERS, '--timeout', '3')
    said = [line.removesuffix(' successful') for line in result.out.splitlines()]
    loaded = [name for name in NAMES if name not in ('start_type_description_service',)]
    assert sorted(said) == [f'Set parameter {name}' for name in loaded if name != 'use_sim_time']
    assert (result.err, result.status) == ('', 0)
    theirs = yaml.safe_load(OTHERS)['/foo/test_node']['ros__parameters']
    assert values() == {**theirs, 'start_type_description_service': True, 'use_sim_time': False}


@pytest.mark.slow
def test_a_wildcard_is_loaded_unless_an_option_forbids_it(load):
    refused = load(WILDCARD, '--no-use-wildcard')
    assert refused.err == 'Param file does not contain selected parameters\n'
    assert (refused.out, refused.status) == ('', 1)
    said = 'Set parameter int_param successful\nSet parameter str_param successful\n'
    assert load(WILDCARD).out == said
    assert (values()['int_param'], values()['str_param']) == (12345, 'Wildcard')


@pytest.mark.slow
def test_parameters_for_the_node_override_a_wildcard(load):
    load(f'{WILDCARD}\n{OVERLAY}')
    assert (values()['int_param'], values()['str_param']) == (12345, 'Override')


def test_each_refused_parameter_of_a_loaded_file_is_reported(load):
    text = '/foo/test_node:\n  ros__parameters:\n    int_param: 1.5\n    bool_param: false\n'
    result = load(text)
    reason = "Wrong parameter type, expected 'Type.INTEGER' got 'Type.DOUBLE'"
    assert result.err == f'Set parameter int_param failed: {reason}\n'
    assert (result.out, result.status) == ('Set parameter bool_param successful\n', 0)


@pytest.mark.parametrize('text', ['', '- 1', '5', '/foo/test_node: [', '\x00', '/**: {1: 2}',
                                  '/foo/test_node: {ros__parameters: [1]}'])  # fmt: skip
def test_an_invalid_parameter_file_is_reported_without_a_traceback(load, text):
    result = load(text)
    assert 'is not a valid ROS parameter file' in result.err.replace('YAML file', '')
    assert 'Traceback' not in result.err
    assert (result.out, result.status) == ('', 1)
