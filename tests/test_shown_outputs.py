"""Outputs on a feedback page have the course's words in the language of the page."""

import pytest
from course_maker import PIXEL
from nbformat.v4 import new_code_cell, new_notebook, new_output

from grader.authoring.edition_outputs import PANEL, PICTURE
from grader.report.page_parts import MAX_TEXT_CHARACTERS, find_sections, show_data
from grader.report.shown_outputs import MOST_CHARACTERS, in_page_language

RESET = 'reset: no node is running'
REFUSED = (
    'NotRunnable',
    'expected a class Arm, saw nothing of that name: run the answer cell, and if that ends in an '
    'error, fix that first',
)


def shown(output, language='zh_CN'):
    found = in_page_language(output, language)
    if output.output_type == 'error':
        return '\n'.join(found.traceback)
    return found.text if output.output_type == 'stream' else found.data['text/plain']


def error(ename, evalue, traceback):
    return new_output('error', ename=ename, evalue=evalue, traceback=traceback)


def displayed(plain, page=''):
    return new_output('display_data', data={'text/plain': plain, 'text/html': page})


def test_printed_lines_of_the_course_are_translated_and_those_of_a_student_are_not():
    printed = new_output('stream', text=f'{RESET}\nmy own words: 3\n')
    assert shown(printed) == '已重置：没有节点在运行\nmy own words: 3\n'
    assert shown(printed, 'en') == printed.text == f'{RESET}\nmy own words: 3\n'


def test_a_panel_and_a_picture_are_translated():
    assert shown(displayed('Arm: running', f'{PANEL}">Arm: running</pre>')) == 'Arm: 正在运行'
    assert shown(displayed('timeline', f'{PICTURE}timeline">')) == '时间线'
    seen = displayed('Picture of what was seen: 5.0 Hz over 4 s (20 messages)', f'{PICTURE}1')
    assert shown(seen) == '所看到的内容的图：4 s 内为 5.0 Hz（20 条消息）'
    assert shown(displayed('nobody knows this')) == 'nobody knows this'


def test_an_error_that_is_a_sentence_of_the_course_is_translated():
    name, said = REFUSED
    whole = f'{name}: {said}'
    assert shown(error(name, said, [whole[:63], whole[63:]])) == whole[:63] + '\n' + whole[63:]
    broken = whole.replace('name: run the', 'name: run\nthe').split('\n')
    translated = shown(error(name, said, broken)).replace('\n', '')
    assert translated.startswith('NotRunnable：预期：有类 Arm；实际：没有这个名称。')
    raised = ['Traceback (most recent call last)', 'ValueError: no message']
    assert shown(error('ValueError', 'no message', raised)) == '\n'.join(raised)


@pytest.mark.parametrize(
    'output',
    [
        displayed('', PICTURE),
        displayed('a: b', PANEL),
        displayed('(', '<img'),
        displayed('x' * (MOST_CHARACTERS + 1), PICTURE),
        new_output('stream', text=f'{RESET}\n' * MOST_CHARACTERS),
        error('E', 'x', []),
        new_output('execute_result', data={}),
        new_output('display_data', data={'image/png': 'x'}),
    ],
)
def test_any_output_of_a_student_can_be_shown(output):
    assert 'output_type' in in_page_language(output, 'zh_CN')


def test_what_the_page_says_of_an_output_is_in_its_language():
    [drawn] = show_data({'image/png': PIXEL, 'text/plain': '<Figure>'}, '', 'zh_CN')
    assert drawn.alt == '这个单元格画的图'
    [other] = show_data({'image/png': PIXEL, 'text/plain': 'my plot'}, '', 'zh_CN')
    assert other.alt == 'my plot'
    printed = new_output('stream', text='x' * (MAX_TEXT_CHARACTERS + 7))
    notebook = new_notebook(cells=[new_code_cell(outputs=[printed])])
    [(_, [piece])] = find_sections(notebook, 'zh_CN')[1]
    assert piece.content.endswith('x\n[还有 7 个字符]')
