"""Stored outputs of an edition's lessons: the course's own words are translated."""

import html
import re

import nbformat
import pytest
from my_robot_basics.doctor import as_html
from my_robot_basics.drawing.described import png_output
from my_robot_basics.live.output import panel
from nbformat.v4 import new_output

from grader.authoring import edition_outputs
from grader.authoring.edition_outputs import OutputWords
from grader.course import ROOT, Course

WORDS = OutputWords(ROOT / 'locale', 'zh_CN')
TREE = '├── src/                          '
PRINTED = {
    'made     $ROS_WS/src/arm: the package, yours to edit\n': (
        '已建立   $ROS_WS/src/arm：功能包，由你编辑\n'
    ),
    f'{TREE}sources: what you write\n': f'{TREE}源代码：你写的内容\n',
    'spare: started\n': 'spare：已启动\n',
    'In a terminal, join this lesson: export ROS_DOMAIN_ID=11\r\n': (
        '在终端里加入这一课：export ROS_DOMAIN_ID=11\r\n'
    ),
    'int count                    refused: there is no type int: write int32 or another int with '
    'its number of bits': (
        'int count                    被拒绝：没有类型 int：请写 int32，或者带有位数的其他 int'
    ),
    'run 2: rclpy is initialised already, by the first run(...) or by your own cell: leave '
    'rclpy.init() out here, and run this cell again\n': (
        'run 2: rclpy 已经初始化了，是由第一个 run(...) 或者你自己的单元格做的：'
        '请在这里去掉 rclpy.init()，再运行这个单元格\n'
    ),
}
NOT_OURS = (
    'by hand:            (1.073, 1.273) m',
    'there is a server: True',
    'not spun:     []',
    'stops on request: stopped',
    'RELIABLE lost none: True',
    '147 of 300 by elbow_down',
    "Package 'hello_arm' not found",
    'refused: Failed to create publisher: create_publisher() called for existing topic name',
    '[INFO] [arm]: no node is running',
)
PANEL = """Arm: stopped
[INFO] [arm]: running
ValueError: the third tick
  line 4, in tick: raise ValueError('no node is running')
  Arm goes on"""
DOCTOR = (
    f'<div style="{as_html.STYLE}"><p>Something is wrong on /a: /b serves, /c asks.</p>\n<ol>\n'
    '<li><b>the callback returned no response</b><br>\n<i>to do</i> end the callback with this '
    'line, in each of its branches; then ask again:\n<pre>return &#x27;no node is running&#x27;'
    '</pre></li>\n</ol></div>'
)
LESSONS = Course().assignments()


def shown(output):
    WORDS.translate(output)
    return output


@pytest.mark.parametrize(('english', 'chinese'), PRINTED.items())
def test_lines_printed_by_the_course_are_translated(english, chinese):
    assert shown(new_output('stream', text=english)).text == chinese


@pytest.mark.parametrize('line', NOT_OURS)
def test_lines_printed_by_lesson_code_or_ros2_are_not_translated(line):
    assert shown(new_output('stream', text=line)).text == line


def test_a_panel_translates_the_state_of_its_node_and_keeps_its_log():
    page = f'<pre style="{panel.STYLE}">{PANEL}</pre>'
    assert page.startswith(edition_outputs.PANEL)
    data = shown(new_output('display_data', {'text/html': page, 'text/plain': PANEL})).data
    first, *log, last = data['text/plain'].split('\n')
    assert (first, last) == ('Arm: 已停止', '  Arm 继续运行')
    assert log[:-1] == PANEL.split('\n')[1:-2]
    assert log[-1] == "  第 4 行，在 tick 里：raise ValueError('no node is running')"
    assert data['text/html'].endswith('Arm 继续运行</pre>')
    assert data['text/html'].startswith(f'<pre style="{panel.STYLE}">Arm: 已停止\n')


def test_a_report_of_the_doctor_is_translated_except_for_its_code():
    assert DOCTOR.startswith(edition_outputs.DOCTOR)
    page = shown(new_output('display_data', {'text/html': DOCTOR, 'text/plain': ''})).data
    assert page['text/html'] == (
        f'<div style="{as_html.STYLE}"><p>/a 有问题：/b 提供，/c 请求。</p>\n<ol>\n'
        '<li><b>回调没有返回响应</b><br>\n<i>做法</i> 回调的每个分支都要以这一行结束；'
        '然后再请求一次：\n<pre>return &#x27;no node is running&#x27;</pre></li>\n</ol></div>'
    )


def test_the_value_of_an_expression_is_not_translated():
    value = new_output('execute_result', {'text/plain': 'no node is running'}, execution_count=1)
    assert shown(value).data['text/plain'] == 'no node is running'


PICTURES = {
    'graph: /a (x_msgs/msg/T): nobody → /b and /c; on no topic: /d': (
        '计算图：/a (x_msgs/msg/T)：没有节点 → /b 和 /c；不在任何话题上：/d'
    ),
    'timeline: one thread, "no" group: 3 times, gaps from 1.0 to 2.0 ms; b: 0 of 4 received': (
        '时间线：one thread, "no" group：3 次，间隔从 1.0 到 2.0 ms；b：4 条中收到 0 条'
    ),
    'Pictures from /camera: all\nRELIABLE: 3 of 4': (
        'Pictures from /camera: all\nRELIABLE：4 条中收到 3 条'
    ),
    'graph of /s: /a serves, nobody asks; 1 goal goes on; broken: no client (it is busy)': (
        '/s 的计算图：/a 提供，没有节点请求；有 1 个目标正在执行；'
        '出问题的：没有客户端（it is busy）'
    ),
    'a picture of my own: nothing to see': 'a picture of my own: nothing to see',
}


@pytest.mark.parametrize(('english', 'chinese'), PICTURES.items())
def test_the_words_for_a_picture_are_translated_and_its_labels_and_pixels_stay(english, chinese):
    data, metadata = png_output(b'pixels', english)
    pixels = data.pop('image/png')
    output = shown(new_output('display_data', data, metadata=metadata))
    again, about = png_output(pixels, english, 'zh_CN')  # what a kernel of the edition shows
    assert output.data == {k: text for k, text in again.items() if k != 'image/png'}
    assert output.metadata == about
    assert output.data['text/plain'] == chinese
    assert about['image/png']['alt'] == chinese.replace('\n', '；')
    source = 'src="data:image/png;base64,cGl4ZWxz">'
    escaped = html.escape(about['image/png']['alt'])
    assert output.data['text/html'] == f'<img alt="{escaped}" {source}'


def pictures_of(folder, name):
    lesson = nbformat.read(ROOT / folder / name / f'{name}.ipynb', as_version=4)
    outputs = [output for cell in lesson.cells for output in cell.get('outputs', [])]
    pages = [output.get('data', {}).get('text/html', '') for output in outputs]
    return [re.fullmatch('<img alt="(.*?)" (.*)>', p, re.DOTALL) for p in pages if '<img' in p]


@pytest.mark.parametrize('name', LESSONS)
def test_each_picture_of_a_released_lesson_has_words_in_chinese(name):
    english, chinese = (pictures_of(folder, name) for folder in ('notebooks', 'notebooks/zh_CN'))
    assert [found[2] for found in chinese] == [found[2] for found in english]
    assert [found[1] for found in chinese if not re.search('[\u3400-\u9fff]', found[1])] == []


@pytest.mark.parametrize('name', LESSONS)
def test_no_display_of_the_course_is_in_english_in_a_released_lesson(name):
    path = ROOT / 'notebooks/zh_CN' / name / f'{name}.ipynb'
    lesson = nbformat.read(path, as_version=4)
    pages = [
        output.data['text/html']
        for cell in lesson.cells
        for output in cell.get('outputs', [])
        if output.get('data', {}).get('text/html')
    ]
    ours = [p for p in pages if p.startswith((edition_outputs.PANEL, edition_outputs.DOCTOR))]
    # the text outside of code and log lines
    texts = [re.sub(r'<pre style="margin:2px.*?</pre>|\n(?s:.*)', '', page) for page in ours]
    assert [text for text in texts if not re.search('[\u3400-\u9fff]', text)] == []
