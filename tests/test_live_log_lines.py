"""Log records among everything else that goes to stdout."""

import pytest
from my_robot_basics.live.output.log_lines import CONSOLE_FORMAT, LogRecord, Splitter

END = '\x1f'
A = '[INFO] [1795273829.565929470] [a_node]: '
B = '[WARN] [1795273829.565929471] [b_node]: '


def split(*pieces, give_up=True):
    """Feed the pieces; records of a_node are wanted. Return (records, forwarded text)."""
    records, forwarded = [], []

    def take(record):
        if record.logger.split('.')[0] == 'a_node':
            records.append(record)
            return True
        return False

    splitter = Splitter(take=take, forward=forwarded.append)
    for piece in pieces:
        splitter.feed(piece if isinstance(piece, bytes) else piece.encode())
    if give_up:
        splitter.give_up_waiting()
    return [record.text for record in records], b''.join(forwarded).decode(errors='replace')


@pytest.mark.parametrize(
    ('pieces', 'texts', 'forwarded'),
    [
        ([f'{A}hello{END}\n'], ['hello'], ''),
        ([f'{A}one\ntwo{END}\nplain\n'], ['one\ntwo'], 'plain\n'),
        ([f'{A}one\n', f'two{END}\n'], ['one\ntwo'], ''),
        (['[IN', f'{A[3:]}split', f' θ{END}', '\n'], ['split θ'], ''),
        ([f'{A}θ'.encode()[:-1], f'θ{END}\n'.encode()[1:]], ['θ'], ''),
        ([f'{A}\n{END}\n'], ['\n'], ''),
        ([f'{A}a\r\nb{END}\n'], ['a\r\nb'], ''),
        # not wanted: forwarded without the separator
        ([f'{B}other{END}\n{A}mine{END}\n'], ['mine'], f'{B}other\n'),
        # logging began before the separator was configured
        ([f'{A}one\n'], ['one'], ''),
        ([f'{A}one\n{A}two\n{B}three\nplain\n'], ['one', 'two'], f'{B}three\nplain\n'),
        # everything else passes, byte for byte
        (['no newline'], [], 'no newline'),
        (['[####    ]', ' 50 %\r', '[########]\r\n'], [], '[####    ] 50 %\r[########]\r\n'),
        (['[INFO] but not a log line\n'], [], '[INFO] but not a log line\n'),
        ([b'\x00\xff\n'], [], '\x00�\n'),
        (['', '\n\n'], [], '\n\n'),
    ],
)
def test_log_records_of_a_node_are_taken_and_other_output_is_forwarded(pieces, texts, forwarded):
    assert split(*pieces) == (texts, forwarded)


def test_a_log_record_has_severity_and_child_logger():
    records = []
    splitter = Splitter(take=lambda r: not records.append(r), forward=pytest.fail)
    splitter.feed(f'[ERROR] [1.0] [arm.left]: ouch{END}\n'.encode())
    assert records == [LogRecord('ERROR', 'arm.left', 'ouch')]


def test_plain_text_is_not_held_back():
    assert split('password: ', give_up=False) == ([], 'password: ')
    assert split('[', give_up=False) == ([], '')


def test_the_format_ends_in_the_separator():
    assert CONSOLE_FORMAT.endswith('{message}' + END)
