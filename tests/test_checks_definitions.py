"""Texts of interface definitions: right in any form, and each mistake named with its cause."""

import sys

import pytest
from my_robot_basics.checks import CheckFailed, Definitions
from my_robot_basics.feedback import hidden
from my_robot_basics.live import show_definition
from my_robot_basics.ros2.definitions import MOST_CHARACTERS, read_definition
from my_robot_basics.session.errors import WrongType

PACKAGE = 'turn_interfaces'
TURNS = """
uint8 MOTOR1=0
uint8 MOTOR2=1
std_msgs/Header header
int32[2] turns
float64[2] gear_ratios [100.0, 50.0]
"""
COUNT_TURNS = """
uint8 motor
builtin_interfaces/Duration duration
---
bool success
string message
int32[<=60] each_second
Turns total
"""
NAMES = {
    'turns_msg': 'header turns gear_ratios MOTOR1 MOTOR2',
    'count_turns_srv': 'motor duration --- success message each_second total',
}
POINTS = {'turns_msg': 1.0, 'count_turns_srv': 2.0}


@pytest.fixture
def check(monkeypatch):
    """Judge two texts as the lesson's grade cell does; a text that is left out is right."""

    def run(turns_msg=TURNS, count_turns_srv=COUNT_TURNS):
        notebook = {'turns_msg': turns_msg, 'count_turns_srv': count_turns_srv}
        for name, text in notebook.items():
            monkeypatch.setattr(sys.modules['__main__'], name, text, raising=False)
            if text is None:
                monkeypatch.delattr(sys.modules['__main__'], name)
        texts = Definitions(
            PACKAGE, turns_msg='msg/Turns.msg', count_turns_srv='srv/CountTurns.srv'
        )
        texts.expect_names(**NAMES)
        texts.expect_definitions(turns_msg=TURNS, count_turns_srv=COUNT_TURNS)
        texts.conclude(POINTS)

    return run


def turns(old, new):
    assert old in TURNS
    return {'turns_msg': TURNS.replace(old, new)}


def count(old, new):
    assert old in COUNT_TURNS
    return {'count_turns_srv': COUNT_TURNS.replace(old, new)}


# --- right ---------------------------------------------------------------------------------------

RIGHT = {
    'as asked': {},
    'in another order': {
        'turns_msg': '\n'.join(reversed(TURNS.splitlines())),
        'count_turns_srv': 'builtin_interfaces/Duration duration\nuint8 motor\n---\nTurns total\n'
        'int32[<=60] each_second\nstring message\nbool success',
    },
    'with comments': turns('int32[2] turns', '# of both\nint32[2] turns # = no [constant]\n\n#'),
    'with spaces and tabs': turns('int32[2] turns', 'int32[2]  \t turns   '),
    'spaces around =': turns('MOTOR2=1', 'MOTOR2 = 1'),
    'indented as a whole': {'turns_msg': TURNS.replace('\n', '\n    ')},
    'windows line ends': {'count_turns_srv': COUNT_TURNS.replace('\n', '\r\n')},
    'with its package': count('Turns total', f'{PACKAGE}/Turns total'),
    'whole numbers as defaults': turns('[100.0, 50.0]', '[100,50]'),
    'an octal constant': turns('MOTOR2=1', 'MOTOR2=0x01'),
    'char, which is uint8': count('uint8 motor', 'char motor'),
    'the default value that rosidl writes anyway': count('bool success', 'bool success false'),
    'that of two numbers': turns('int32[2] turns', 'int32[2] turns [0, 0]'),
    'that of any number': count('each_second', 'each_second []'),
    'wide characters in a comment': turns('int32[2] turns', 'int32[2] turns # \uff1d\uff03 //'),
}


@pytest.mark.parametrize('texts', RIGHT.values(), ids=RIGHT)
def test_right_definitions_pass_in_any_form(check, texts, capfd):
    check(**texts)
    assert capfd.readouterr() == ('', '')


# --- wrong ---------------------------------------------------------------------------------------

WRONG = {
    'int': (turns('int32[2] turns', 'int turns'), 'there is no type int: write int32'),
    'float': (turns('float64[2]', 'float[2]'), 'there is no type float: write float64'),
    'String': (count('string message', 'String message'), 'write string'),
    'capital type': (count('bool success', 'BOOL success'), 'in lower case: bool'),
    'camelCase': (turns('gear_ratios', 'gearRatios'), 'lower case, with single _: gear_ratios'),
    'hyphen': (turns('gear_ratios', 'gear-ratios'), 'lower case, with single _: gear_ratios'),
    'capital field': (turns('int32[2] turns', 'int32[2] Turns'), 'with single _: turns'),
    'constant in lower case': (turns('MOTOR1=0', 'motor1=0'), 'in capital letters (MOTOR1)'),
    'constant of C': (turns('MOTOR1=0', 'motor1=0;'), 'no line ends with a semicolon'),
    'constant without =': (turns('MOTOR1=0', 'MOTOR1 0'), 'a constant has = and a value'),
    'default with =': (turns('gear_ratios [', 'gear_ratios = ['), 'is written without ='),
    'no separator': (count('---\n', ''), 'one line --- between the request and the response, and'),
    'two separators': (count('---\n', '---\n---\n'), 'and there are 2'),
    'space behind ---': (count('---', '--- '), 'not even a space'),
    'comment behind ---': (count('---', '--- # response'), 'not even a space'),
    'four dashes': (count('---', '----'), 'separated by three dashes'),
    'Header alone': (turns('std_msgs/Header', 'Header'), 'before it, std_msgs/Header'),
    'Duration alone': (
        count('builtin_interfaces/Duration', 'Duration'),
        'before it, builtin_interfaces/Duration',
    ),
    'with msg': (
        turns('std_msgs/Header', 'std_msgs/msg/Header'),
        'no msg in its name: std_msgs/H',
    ),
    'with colons': (turns('std_msgs/Header', 'std_msgs::Header'), 'with a slash: std_msgs/Header'),
    'with a dot': (turns('std_msgs/Header', 'std_msgs.msg.Header'), 'no msg in its name'),
    'a message in lower case': (
        turns('std_msgs/Header', 'std_msgs/header'),
        'a message of another package is written like std_msgs/Header',
    ),
    'another package': (
        turns('std_msgs/Header', 'sensor_msgs/Header'),
        'there is no message type',
    ),
    'ROS 1': (count('builtin_interfaces/Duration', 'duration'), 'is a type of ROS 1'),
    'one default for two': (turns('[100.0, 50.0]', '100.0'), 'a list of as many values'),
    'three defaults for two': (turns('50.0]', '50.0, 1.0]'), 'a list of as many values'),
    'braces': (turns('[100.0, 50.0]', '{100.0, 50.0}'), 'a list of as many values'),
    'a default of a message': (
        count('Duration duration', 'Duration duration 5.0'),
        "a message has no default value: leave out '5.0', or write # before it",
    ),
    'as in C': (turns('int32[2] turns', 'int32 turns[2]'), 'brackets belong to the type'),
    'as in C, at most': (
        count('int32[<=60] each_second', 'int32 each_second[<=60]'),
        'brackets belong to the type',
    ),
    'a space before the bits': (
        turns('int32[2]', 'int 32[2]'),
        'there is no type int: write int32',
    ),
    'a bound without brackets': (
        count('int32[<=60]', 'int32<=60'),
        'written with brackets: float',
    ),
    'name first': (
        count('bool success', 'success bool'),
        'the type comes first, then the name: f',
    ),
    'name before an array': (turns('int32[2] turns', 'turns int32[2]'), 'the type comes first'),
    "C's comment": (
        turns('int32[2] turns', 'int32[2] turns  // of both'),
        'comment begins with #',
    ),
    "a line of C's comment": (
        turns('int32[2]', '/* of both */\nint32[2]'),
        'comment begins with #',
    ),
    'a constant without a type': (
        turns('uint8 MOTOR1=0', 'MOTOR1 = 0'),
        'its type before its name',
    ),
    'a wide =': (turns('MOTOR1=0', 'MOTOR1\uff1d0'), "a full-width character: write '='"),
    'a 2 that is raised': (turns('int32[2]', 'int32[\u00b2]'), 'exactly two values [2]'),
    'a wide #': (turns('turns\n', 'turns \uff03 of both\n'), "a full-width character: write '#'"),
    'a no-break space': (
        turns('int32[2] turns', 'int32[2]\u00a0turns'),
        'a no-break space or the',
    ),
    'brackets of a Chinese keyboard': (
        turns('int32[2]', 'int32\u30102\u3011'),
        "it has '\u3010', a full-width character: write '['",
    ),
    'a dash of a word processor': (
        turns('MOTOR1=0', 'MOTOR1=\u20130'),
        "it has '\u2013': write '-' in its place",
    ),
    'an invisible character': (turns('int32[2] ', 'int32[2]\u200b '), 'an invisible character'),
    'a byte order mark': ({'turns_msg': '\ufeff' + TURNS.strip()}, 'an invisible character'),
    'a list of Markdown': (
        turns('int32[2]', '- int32[2]'),
        "a line begins with its type, without '-' before it",
    ),
    'the table of the task': (
        turns('std_msgs/Header header', '| header | std_msgs/Header |'),
        "a line begins with its type, without '|' before it",
    ),
    'a constant without a type or a space': (
        turns('uint8 MOTOR1=0', 'MOTOR1=0'),
        'its type before its name',
    ),
    'a type of two words': (
        turns('uint8 MOTOR1', 'unsigned char MOTOR1'),
        'there is no type unsigned: write',
    ),
    'a vector of C++': (turns('int32[2]', 'vector<int32>'), 'exactly two values [2]'),
    'the name of the file': (count('Turns total', 'Turns.msg total'), 'after its name: Turns'),
    'std_msgs': (count('bool success', 'std_msgs/Bool success'), 'write the plain type, bool'),
    'space in the type': (turns('int32[2]', 'int32 [2]'), 'no space between a type and its'),
    'bound with <': (count('[<=60]', '[<60]'), 'at most two [<=2]'),
    'bound the wrong way': (count('[<=60]', '[60<=]'), 'at most two [<=2]'),
    'Python': (count('bool success', 'success: bool'), 'the type comes first'),
    'semicolon': (count('bool success', 'bool success;'), 'no line ends with a semicolon'),
    'a default behind =': (
        turns('gear_ratios [', 'gear_ratios=['),
        'the default value of a field is written without =',
    ),
    'const': (turns('uint8 MOTOR1', 'const uint8 MOTOR1'), 'leave out const'),
    'Markdown': (turns('uint8 MOTOR1', '```msg\nuint8 MOTOR1'), 'a mark of Markdown'),
    'a heading': (count('bool success', 'Response:\nbool success'), 'a heading begins with #'),
    'no name': (count('bool success', 'bool'), 'a line has a type and a name'),
    'a bound and no name': (count(' each_second', ''), 'a line has a type and a name'),
    'indented line': (count('string message', '  string message'), 'no space before the type'),
    'keyword': (count('bool success', 'bool success\nstring from'), 'from is a word of Python'),
    'twice': (count('bool success', 'bool success\nbool success'), 'two of the name success'),
    'too large a value': (turns('MOTOR2=1', 'MOTOR2=256'), "rosidl says: value '256' can not be"),
    'a space inside the brackets': (
        count('[<=60]', '[<= 60]'),
        'no space inside the brackets of a type: float64[<=2] name',
    ),
    'a type of C': (count('uint8 motor', 'uint8_t motor'), 'no type uint8_t: write uint8'),
    'its own message in lower case': (
        count('Turns total', 'turns total'),
        'no type turns: the type of a message begins with a capital letter',
    ),
    'float32': (turns('float64[2]', 'float32[2]'), 'another number of bits'),
    'unsigned': (turns('int32[2]', 'uint32[2]'), 'whole numbers that may be negative'),
    'signed constant': (turns('uint8 MOTOR1', 'int8 MOTOR1'), 'that are never negative'),
    'whole for float': (
        turns('float64[2] gear_ratios [100.0, 50.0]', 'int64[2] gear_ratios [100, 50]'),
        'asks for floating-point numbers',
    ),
    'a number for a message': (
        count('builtin_interfaces/Duration', 'float64'),
        'see in the table whether it is a number',
    ),
    'Time': (count('/Duration', '/Time'), 'see in the table what it is'),
    'unbounded': (count('[<=60]', '[]'), 'takes any number of values'),
    'fixed for bounded': (count('[<=60]', '[60]'), 'takes exactly so many values, [60]'),
    'bounded for fixed': (turns('int32[2]', 'int32[<=2]'), 'takes at most so many'),
    'one value': (turns('int32[2]', 'int32'), 'takes one value'),
    'another length': (turns('int32[2]', 'int32[3]'), 'another number of values'),
    'bounded text': (count('string m', 'string<=9 m'), 'a text of another length'),
    'no default': (turns(' [100.0, 50.0]', ''), 'gear_ratios has no default value'),
    'another default': (turns('50.0]', '51.0]'), 'another default value'),
    'a default that nobody wants': (
        count('success', 'success true'),
        'the table asks for no def',
    ),
    'a default of one zero for any number': (
        count('each_second', 'each_second [0]'),
        'the table asks for no default value of each_second',
    ),
    'another constant': (turns('MOTOR2=1', 'MOTOR2=2'), 'the constant MOTOR2 has another value'),
    'missing': (count('Turns total\n', ''), 'the response has no total'),
    'misspelt': (count('each_second', 'every_second'), 'is it called every_second?'),
    'too much': (
        count('bool success', 'bool success\nint32 more'),
        'more, which the table does not',
    ),
    'in the other part': (
        {'count_turns_srv': COUNT_TURNS.replace('uint8 motor\n', '') + 'uint8 motor\n'},
        'motor is in the response, and belongs to the request',
    ),
    'in both parts': (count('bool success', 'bool success\nuint8 motor'), 'motor is in the respo'),
    'empty': ({'turns_msg': '# YOUR CODE HERE'}, 'in `turns_msg`, there is no field yet'),
    'no such name': (
        {'turns_msg': None},
        'in `turns_msg`, expected a value for `turns_msg`, saw no',
    ),
    'no text': ({'count_turns_srv': ['uint8 motor']}, 'expected `count_turns_srv` to be'),
}


@pytest.mark.parametrize(('texts', 'words'), WRONG.values(), ids=WRONG)
def test_each_mistake_costs_only_the_points_of_its_text_and_is_named(check, texts, words, capfd):
    [name] = texts
    with pytest.raises(CheckFailed) as failure:
        check(**texts)
    said = str(failure.value)
    assert said.startswith('expected each text to define what its table says, saw something else ')
    assert words in said
    left = 3.0 - POINTS[name]
    assert f'in `{name}`, which leaves {left:g} of 3 points: in `{name}`, ' in said
    assert capfd.readouterr().err == ''  # rosidl prints there


def test_mistakes_in_both_texts_are_both_named_and_leave_no_points(check):
    with pytest.raises(CheckFailed) as failure:
        check(**turns('int32', 'int'), **count('[<=60]', '[]'))
    said = str(failure.value)
    assert 'leaves' not in said
    assert 'in `turns_msg`, ' in said
    assert '; in `count_turns_srv`, ' in said


def test_the_first_three_of_many_mistakes_are_named(check):
    with pytest.raises(CheckFailed, match=r'; and 2 more$'):
        check('int a\nint b\nint c\nint d\nint e')


def test_a_notebook_without_texts_fails_with_the_missing_name(check):
    with pytest.raises(
        CheckFailed, match=r'^expected a value for `turns_msg`, saw no such name: '
    ):
        check(None, None)


def test_the_visible_part_reports_no_remaining_points(monkeypatch):
    monkeypatch.setattr(sys.modules['__main__'], 'turns_msg', 'int turns', raising=False)
    monkeypatch.setattr(sys.modules['__main__'], 'count_turns_srv', COUNT_TURNS, raising=False)
    texts = Definitions(PACKAGE, turns_msg='msg/Turns.msg', count_turns_srv='srv/CountTurns.srv')
    texts.expect_names(**NAMES)
    with pytest.raises(CheckFailed) as failure:
        texts.conclude(POINTS)
    assert 'leaves' not in str(failure.value)


def test_a_hidden_check_names_the_same_mistake(check, monkeypatch):
    monkeypatch.setattr(hidden, '_quiet', True)
    with pytest.raises(CheckFailed, match=r'int64.*: the table asks for another number of bits'):
        check(**turns('int32[2]', 'int64[2]'))


# --- hostile -------------------------------------------------------------------------------------

HOSTILE = {
    'a name that rosidl reads for hours': 'uint8 ' + 'A' * 60 + 'a=1',
    'the same without an end': 'uint8 ' + 'A_' * 90 + '=1',
    'the same before a bound': 'int32 ' + 'A' * 60 + '<=5',
    'fields without end': '\n'.join(f'int32 field{n}' for n in range(100_000)),
    'one long line': 'int32 ' + 'a' * 60_000,
    'a number without end': f'float64[{"9" * 250}] turns',
    'many unknown types': '\n'.join(f'a{n}/B turns{n}' for n in range(199)),
    'brackets': '[' * 9_000,
    'spaces in a comment': '# ' + ' ' * 9_000 + '[',
    'a path': '../../etc/passwd turns\n../etc/Turns turns',
    'a path for a package': 'std_msgs/../Header header',
    'escapes': '\x1b[31mint32\x07 turns\x00\u202e\u2066 turns\u2069',
    'other line ends': 'int32 a\x0bint32 b\x85int32 c\u2028int32 d',
    'quotes': 'string name "' + '\\"' * 140,
    'a list of quotes': 'string[] name [' + "'," * 130 + ']',
    'a format': 'int32 {turns!r} %s %d',
    'surrogates': 'int32 \ud800',
}


@pytest.mark.parametrize('text', HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_text_fails_with_one_short_printable_sentence(check, text, capfd):
    with pytest.raises(CheckFailed) as failure:
        check(turns_msg=text)
    said = str(failure.value)
    assert len(said) < 1_500
    assert said.isprintable()
    assert 'leaves 2 of 3 points' in said
    assert capfd.readouterr().err == ''


def test_a_text_of_the_maximum_length_is_read_and_a_longer_one_refused():
    text = TURNS + '#' * (MOST_CHARACTERS - len(TURNS))
    read = read_definition(text, package=PACKAGE, kind='msg', own_types=())
    assert read.faults == []
    assert read_definition(f'{text}#', package=PACKAGE, kind='msg', own_types=()).faults != []


def test_an_action_has_three_parts():
    text = 'int32 a\n---\nint32 b\n---\nint32 c'
    read = read_definition(text, package=PACKAGE, kind='action', own_types=())
    assert [list(section) for section in read.sections] == [['a'], ['b'], ['c']]
    assert read.faults == []
    short = read_definition('int32 a\n---\nint32 b', package=PACKAGE, kind='action', own_types=())
    assert short.faults == [
        'there is to be two lines --- between the goal, the result and the feedback, '
        'and there are 1'
    ]


def test_a_wrong_definition_in_a_check_is_the_authors_mistake(check, monkeypatch):
    monkeypatch.setattr(sys.modules['__main__'], 'motor_msg', 'int32 a', raising=False)
    texts = Definitions(PACKAGE, motor_msg='msg/Motor.msg')
    with pytest.raises(ValueError, match='the definition for motor_msg is none'):
        texts.expect_definitions(motor_msg='int a')


# --- in a notebook -------------------------------------------------------------------------------


def test_show_definition_explains_each_line(capsys):
    show_definition('uint8 OPEN=1\nfloat64[2] force [1, 2]  # N\n---\nstring[] names\nint n')
    assert capsys.readouterr().out == (
        'uint8 OPEN=1             constant OPEN, uint8, always 1\n'
        'float64[2] force [1, 2]  field force, exactly 2 float64, [1.0, 2.0] if nobody sets it\n'
        '---\n'
        'string[] names           field names, any number of string\n'
        'int n                    refused: there is no type int: write int32 or another int '
        'with its number of bits\n'
    )


@pytest.mark.parametrize(
    ('given', 'seen'), [(['int32 n'], r"a list \(\['int32 n'\]\)"), (None, r'a NoneType \(None\)')]
)
def test_show_definition_refuses_a_value_that_is_not_a_text(given, seen):
    with pytest.raises(WrongType, match=f'^expected a definition to be a text, saw {seen}: write'):
        show_definition(given)


def test_show_definition_names_no_package_for_a_type_without_one(capsys):
    show_definition('Header h')
    said = (
        'refused: your own package has no message Header: write its package before it, std_msgs/'
    )
    assert said in capsys.readouterr().out
