"""Pages, terminals and Validate speak the language of the notebook or the terminal."""

import json

import nbformat
import pytest
from chinese_reason import CHINESE_REASON, REASON
from my_robot_basics.doctor.evidence import Finding
from my_robot_basics.doctor.report import fields
from my_robot_basics.feedback.errors import CheckFailed
from my_robot_basics.language import speaking
from my_robot_basics.language.lines import in_lines
from my_robot_basics.language.speaking import language_of
from my_robot_basics.ros2 import environment
from my_robot_basics.session import overlays
from my_robot_basics.session.lessons import RunningLesson
from my_robot_basics.validate.lessons.cell_names import replace_cell_ids
from my_robot_basics.validate.reports.as_text import as_text
from my_robot_basics.validate.reports.report import CheckFeedback, ExerciseFeedback, Report
from my_robot_basics.validate.text import columns

from grader.course import Course
from grader.notebook.restore import restore
from grader.report.page import render_page


def test_the_line_that_fixes_a_fault_follows_a_colon_of_the_language():
    fix = 'fix that, and send the goal again'
    finding = Finding(title='', expected='', seen='', fix=fix, code='abort()')
    assert fields(finding, 'en')['to do'] == 'fix that, and send the goal again:'
    assert fields(finding, 'zh_CN')['做法'] == '改正它，再发送一次目标：'


def test_messages_beside_ros2_output_are_in_the_language_of_the_terminal(monkeypatch, capsys):
    monkeypatch.delenv('JPY_SESSION_NAME', raising=False)
    monkeypatch.setenv(speaking.OF_TERMINALS, 'zh_CN')
    monkeypatch.setattr(environment, '_joined', RunningLesson(0, 7, 1, '03_publisher'))
    monkeypatch.setattr(overlays, '_said', set())
    environment.print_joined_lesson()
    overlays.say(overlays.gone('/ws/install/arm'))
    joined, gone = capsys.readouterr().err.splitlines()
    assert joined == '已加入最后启动的课 03_publisher：ROS_DOMAIN_ID=7'
    assert gone.startswith('course: /ws/install/arm 已经不在了')


def test_a_terminal_has_the_language_that_the_course_has_chosen(monkeypatch):
    monkeypatch.delenv('JPY_SESSION_NAME', raising=False)
    monkeypatch.setenv(speaking.OF_TERMINALS, 'zh_CN')
    assert speaking.language_here() == 'zh_CN'
    monkeypatch.setenv('JPY_SESSION_NAME', '03_publisher/03_publisher.ipynb')
    assert speaking.language_here() == 'en'  # a lesson's own language counts
    monkeypatch.delenv('JPY_SESSION_NAME')
    for nothing in ('', 'en', 'tlh', '..'):
        monkeypatch.setenv(speaking.OF_TERMINALS, nothing)
        assert speaking.language_here() == 'en'


def test_chinese_is_broken_into_lines_by_columns_and_no_line_begins_with_a_comma():
    text = f'{CHINESE_REASON}；{CHINESE_REASON}，见 /a_long/name_that_stays_whole_in_its_line'
    broken = in_lines(text, 40, first='- ', rest='  ')
    assert len(broken) > 3
    assert all(columns(line) <= 40 for line in broken[:-1])
    assert broken[-1].endswith('/a_long/name_that_stays_whole_in_its_line')
    assert not [line for line in broken if line.strip()[0] in '，。；：）']
    assert not [line for line in broken if line.endswith('（')]
    assert ''.join(broken).replace(' ', '') == f'-{text}'.replace(' ', '')
    assert in_lines('a b ' * 30, 20) == ['a b a b a b a b a b'] * 6


@pytest.mark.parametrize('said', [None, 'tlh', '../..', 3, ['zh_CN'], {'zh_CN': 1}])
def test_a_notebook_with_an_unknown_language_is_treated_as_english(said):
    assert language_of({'my_robot_basics': {'language': said}}) == 'en'
    assert language_of({'my_robot_basics': said}) == 'en'
    assert language_of({}) == 'en'


@pytest.mark.parametrize('name', Course().assignments())
def test_the_same_answers_in_each_edition_are_graded_as_the_same_notebook(name):
    course = Course()
    template = course.template(name)
    path = course.root / 'notebooks/zh_CN' / name / f'{name}.ipynb'
    english, chinese = course.release(name), nbformat.read(path, as_version=4)
    for notebook in (english, chinese):
        for cell in notebook.cells:
            if cell.metadata.get('nbgrader', {}).get('solution'):
                cell.source = f'{cell.source}\ntext = "我的答案"  # 注释'
        notebook.cells.insert(3, nbformat.v4.new_code_cell('mine = "试一试"', id='mine'))
    ours, theirs = restore(english, template), restore(chinese, template)
    assert theirs.notebook.metadata.my_robot_basics.pop('language') == 'zh_CN'
    assert 'language' not in ours.notebook.metadata.my_robot_basics
    assert theirs == ours  # not a cell, not a note differs: what is graded has no language


def graded(language):
    verdict = {'role': 'grade', 'outcome': 'failed', 'reason': REASON, 'notes': []}
    marks = {'grade': True, 'grade_id': 'a', 'points': 2, 'score': 0.0, 'locked': True}
    source = '"""/kinematics/joint_states carries 5 messages a second"""\npass'
    cell = nbformat.v4.new_code_cell(
        source, id='a', metadata={'nbgrader': marks, 'my_robot_basics': verdict}
    )
    notebook = nbformat.v4.new_notebook(cells=[cell])
    notebook.metadata.my_robot_basics = {
        'notes': ["the cell `a` was changed, or is of an earlier release: the lesson's counts"],
        'title': '3 · A node that keeps talking',
        **language,
    }
    return notebook


ABOUT = {'student': 'ada & bob', 'assignment': '03_publisher', 'score': 0.0, 'max_score': 2.0}


def test_the_feedback_page_is_in_the_language_of_the_notebook():
    html = render_page(graded({'language': 'zh_CN'}), ABOUT)
    assert '<html lang="zh-CN">' in html
    for said in (
        '<h1>3 · 一直在发布的节点</h1>',
        '给 ada &amp; bob 的反馈',
        '0 / 2 分',
        '/kinematics/joint_states 每秒传送 5 条消息',
        '✗ 还未通过',
        '预期：/kinematics/joint_states 的频率为 5.0 Hz；实际：10 s 内为 1.0 Hz（10 条消息）。',
        '定时器的周期以秒为单位，周期 = 1 / 频率',
        '单元格 <code>a</code> 被改动了，或来自较早的版本：以本课的为准',
    ):
        assert said in html
    shown = html.partition('</style>')[2]
    for english in ('Expected', 'Feedback', 'Summary', 'points<', 'Next step', 'not yet'):
        assert english not in shown


def test_an_english_notebook_has_an_english_page():
    html = render_page(graded({}), ABOUT)
    assert '<html lang="en">' in html
    assert 'Feedback for ada &amp; bob' in html
    assert '<p class="total">0 of 2 points</p>' in html


def report(language):
    check = CheckFeedback('a', 'Each message has both names', 2.0, 'failed', True, message=REASON)
    made = Report('a.ipynb', (ExerciseFeedback('five_hz', (), (check,)),), (), language)
    return made.with_words(
        lambda text: replace_cell_ids(text, nbformat.v4.new_notebook(), language), title=str
    )


def test_validate_speaks_the_language_of_the_notebook():
    said = ' '.join(as_text(report('zh_CN')).split())
    assert '✗ Each message has both names（0 / 2 分；评分时还有更多检查）' in said
    assert CHINESE_REASON.replace(' ', '') in said.replace(' ', '')
    assert said.endswith('1 项看得见的检查中有 1 项未通过：少了 2 分。')
    data = json.loads(json.dumps(report('zh_CN').as_data()))
    assert data['words']['Show the check'] == '显示这项检查'
    assert data['words']['{earned} of {points}'] == '{earned} / {points}'
    assert set(report('en').as_data()['words'].items()) == {(text, text) for text in data['words']}


def test_a_cell_is_named_by_its_number_in_each_language():
    cell = nbformat.v4.new_code_cell('', metadata={'nbgrader': {'grade_id': 'five_hz'}})
    notebook = nbformat.v4.new_notebook(cells=[cell])
    text = 'the cell `five_hz` was changed: the original counts at grading'
    shown = replace_cell_ids(text, notebook, 'zh_CN')
    assert shown == '单元格 `five_hz`（第 1 个单元格）被改动了：评分时以原来的为准'


def test_a_check_run_in_a_lesson_reports_in_the_language_of_its_edition(monkeypatch):
    failed = CheckFailed(REASON)
    monkeypatch.setenv('JPY_SESSION_NAME', '/home/ada/notebooks/03_publisher/03_publisher.ipynb')
    assert ' '.join(failed._render_traceback_()).endswith(REASON[-20:])
    monkeypatch.setenv('JPY_SESSION_NAME', 'zh_CN/03_publisher/03_publisher.ipynb')
    assert '定时器的周期以秒为单位' in ''.join(failed._render_traceback_())
    assert str(failed) == REASON


def test_every_notebook_is_english_if_there_are_no_catalogues(monkeypatch, tmp_path):
    monkeypatch.setattr(speaking, 'LOCALE', tmp_path)
    assert language_of({'my_robot_basics': {'language': 'zh_CN'}}) == 'en'


def test_the_feedback_page_splits_a_reason_with_colons_into_its_parts():
    notebook = graded({'language': 'zh_CN'})
    notebook.cells[0].metadata.my_robot_basics.update(
        reason='expected [0.5] rad for (30.0) degrees, saw [30.0]: these are degrees: '
        'convert both with radians()',
        failed_at_grading=True,
    )
    notebook.cells[0].source = '"""name holds joint1 and joint2, in this order"""\ncheck()'
    html = render_page(notebook, ABOUT)
    assert '<dt>实际</dt><dd>[30.0]</dd>' in html
    assert '>这些是度：两个都用 radians() 换算</dd>' in html
    assert '评分时检查“name 里依次是 joint1 和 joint2”以外的内容' in html
