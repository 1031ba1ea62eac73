"""A command line is read as a shell would, and starts nothing else than the one executable."""

import shlex

import pytest
from my_robot_basics.ros2.command_line import BadCommandLine, parse

START = 'ros2 run my_robot_basics kinematics_publisher'


def read(text):
    return parse(text, package='my_robot_basics', executable='kinematics_publisher')


@pytest.mark.parametrize(
    'rest',
    [
        '',
        '-r __ns:=/left -r __node:=arm',
        '-r "__ns:=/left" --remap \'__node:=arm\'',
        '-p "text:=a b; c & d"',
        '--params-file "my file.yaml" --',
        r'-r __ns:=/a\ b',
    ],
)
def test_a_command_line_is_split_into_words_as_by_a_shell(rest):
    text = f'  {START} --ros-args {rest}\n'
    assert list(read(text).words) == shlex.split(text)


def test_a_command_may_continue_on_the_next_line_after_a_backslash():
    text = f'{START} --ros-args \\\n    -r __ns:=/left'
    assert read(text).rules() == [('__ns', '/left')]


def test_remap_rules_are_split_at_their_first_separator():
    line = read(f'{START} --ros-args -r __ns:=/left --remap a:=b:=c -p r:=1 -r nothing')
    assert line.rules() == [('__ns', '/left'), ('a', 'b:=c'), ('nothing', '')]


BAD = [
    ('', 'nothing: begin with ros2 run'),
    ('rm -rf /', 'rm -rf /: begin with ros2 run my_robot_basics kinematics_publisher'),
    ('ros2 run my_robot_basics hello_node --ros-args', 'hello_node: begin with'),
    ('ros2 run --prefix id my_robot_basics kinematics_publisher --ros-args', 'begin with'),
    (START + ' --ros-args -r __ns：=/left', "a full-width '：': write ':' in its place"),
    ('!' + START + ' --ros-args', 'begin with'),
    ('A=1 ' + START + ' --ros-args', 'begin with'),
    ('/bin/' + START + ' --ros-args', 'begin with'),
    (START, 'nothing where --ros-args belongs: write --ros-args after'),
    (START + ' -r __ns:=/left', '-r where --ros-args belongs: write --ros-args after'),
    (START + ' --ros-args &', 'the word &: write one command'),
    (START + ' --ros-args -r __ns:=/a; touch x', 'the word ;: write one command'),
    (START + ' --ros-args | tee x', 'the word |: write one command'),
    (START + ' --ros-args > x', 'the word >: write one command'),
    (START + ' --ros-args && id', 'the word &&: write one command'),
    (START + ' --ros-args $(id)', 'a $: write what you mean in full'),
    (START + ' --ros-args `id`', 'a `: write what you mean in full'),
    ('{PUBLISHER} -r __ns:=/left', '{PUBLISHER} itself: put an f before the quotation mark'),
    (START + ' --ros-args -r __ns := /left', 'a space before :=: write no spaces around it'),
    (START + ' --ros-args -r __ns :=/left', 'a space before :='),
    (START + ' --ros-args -r {TOPIC}:=poses', '{TOPIC} itself: put an f before'),
    (START + ' --ros-args\nid', 'several lines: write one line'),
    (START + " --ros-args -r '__ns", 'no closing quotation: close each quotation mark'),
    (START + ' --ros-args ' + 2_000 * 'x', r'\d+ characters: write one command line'),
]


@pytest.mark.parametrize(('text', 'words'), BAD, ids=[text[-30:] or 'empty' for text, _ in BAD])
def test_a_command_line_that_is_not_allowed_is_refused_with_a_correction(text, words):
    with pytest.raises(BadCommandLine, match=words.replace('|', r'\|').replace('$', r'\$')):
        read(text)
