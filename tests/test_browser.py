"""What a student sees: the released lessons in JupyterLab, opened as `./course lab` does."""

import re
import shutil

import nbformat
import psutil
import pytest
from answered import answered
from chromium import LONG, drives_chromium, launched
from lab_browser import (
    LESSONS,
    ROOT,
    TOKEN,
    WIDTH,
    Lab,
    Lesson,
    close_all,
    errors,
    run_through,
    see_the_arm_move,
    wait_until_open,
    warnings,
)
from my_robot_basics.live.packages.workspace import make_workspace
from playwright.sync_api import expect

pytestmark = drives_chromium

WRONG = """\
def to_joint_state(theta1_deg, theta2_deg, stamp):
    message = JointState(name=['joint1', 'joint2'], position=[theta1_deg, theta2_deg])
    message.header.stamp = stamp
    message.header.frame_id = 'base_link'
    return message
"""
RIGHT = WRONG.replace('[theta1_deg, theta2_deg]', '[radians(theta1_deg), radians(theta2_deg)]')


@pytest.fixture(scope='module')
def lab(tmp_path_factory):
    lab = Lab(tmp_path_factory.mktemp('lab'))
    try:
        lab.wait_until_up()
        yield lab
    finally:
        lab.stop()


@pytest.fixture(scope='module')
def chromium():
    with launched() as browser:
        yield browser


@pytest.fixture(scope='module')
def page(lab, chromium):
    """A JupyterLab in the browser, for one lesson after the other: loading one takes long."""
    for name in ('index.ipynb', 'terms.md'):
        shutil.copy(ROOT / 'notebooks' / name, lab.folder)
    page = chromium.new_page(viewport={'width': 1200, 'height': 900})
    page.set_default_timeout(LONG)
    page.goto(f'{lab.address}/?token={TOKEN}')
    page.wait_for_function('window.jupyterapp?.restored.then(() => true)')
    wait_until_open(page, 'index.ipynb')
    yield page
    page.close()


@pytest.fixture
def opened(lab, page):
    close_all(page)
    lessons = []

    def open_lesson(name, language=''):
        lessons.append(Lesson(page, lab.fresh_copy(name, language)))
        return lessons[-1]

    yield open_lesson
    close_all(page)


@pytest.mark.slow
def test_the_lab_opens_the_contents_page_and_renders_the_terms(page):
    expect(page.get_by_role('link', name='core terms')).to_be_visible()
    # a link would show it without our settings, too
    page.locator('.jp-DirListing-item', has_text='terms.md').dblclick()
    expect(page.locator('.jp-MarkdownViewer table').first).to_be_visible()


@pytest.mark.slow
def test_the_contents_page_shows_passed_and_since_changed_exercises(lab, page):
    name = '02_joint_state'
    notebook = answered(name, lab.folder / name)
    opened = f'{name}/{name}.ipynb'
    close_all(page)
    Lesson(page, 'index.ipynb')
    progress = page.locator('.mrb-progress')
    of_lesson = progress.locator('.mrb-progress-lesson', has_text='to_joint_state')
    expect(progress).to_contain_text('Passed in Validate: 0 of ')
    expect(of_lesson).to_contain_text('○')
    of_lesson.get_by_role('link').click()
    wait_until_open(page, opened)
    assert 'All visible checks pass' in Lesson(page, opened).validate()
    Lesson(page, 'index.ipynb')
    expect(progress).to_contain_text('Passed in Validate: 1 of ')
    expect(of_lesson).to_contain_text('✓')
    Lesson(page, opened)
    text = notebook.read_text()
    notebook.write_text(text.replace('radians(theta1_deg)', 'theta1_deg').replace('theta', 'phi'))
    Lesson(page, 'index.ipynb')
    expect(of_lesson).to_contain_text('↻')
    expect(progress).to_contain_text('changed since it passed')
    close_all(page)


@pytest.mark.slow  # test_workspace.py sees its link
def test_the_workspace_opens_in_the_file_browser(lab, page, monkeypatch):
    workspace = lab.folder.parent / 'ros_ws'
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(workspace))
    make_workspace()
    (lab.folder / 'ros_ws').symlink_to('../ros_ws')  # as make_workspace does in the course
    page.evaluate("jupyterapp.commands.execute('filebrowser:refresh')")
    try:
        for name in ('ros_ws', 'src', 'my_robot_basics', 'setup.py'):
            page.locator('.jp-DirListing-item', has=page.get_by_text(name, exact=True)).dblclick()
        expect(page.locator('.jp-FileEditor')).to_contain_text('kinematics_publisher:main')
        page.locator('.jp-FileEditor .cm-content').click()
        page.keyboard.insert_text('# mine\n')
        page.evaluate("jupyterapp.commands.execute('docmanager:save')")
        assert '# mine' in (workspace / 'src/my_robot_basics/setup.py').read_text()
    finally:
        page.evaluate("jupyterapp.commands.execute('filebrowser:go-to-path', {path: '/'})")
        close_all(page)


@pytest.mark.parametrize('name', LESSONS)
def test_run_all_runs_an_unanswered_lesson_to_its_end(opened, name):
    lesson = opened(name)
    run_through(lesson)
    [check, *_] = [c.id for c in lesson.cells if c.metadata.get('nbgrader', {}).get('grade')]
    expect(lesson.shown(check)).to_contain_text('saw none yet: write it into the answer cell')


@pytest.mark.slow
def test_validate_stays_in_sight_in_a_narrow_window(opened, page):
    opened('02_joint_state')
    toolbar, before = page.locator('.jp-NotebookPanel-toolbar'), page.viewport_size
    expect(toolbar.locator('[data-jp-item-name="kernelName"]')).to_be_visible()
    page.set_viewport_size({'width': 800, 'height': 900})
    try:
        expect(toolbar.locator('[data-jp-item-name="kernelName"]')).to_have_count(0)
        expect(toolbar.get_by_role('button', name='Validate')).to_be_visible()
    finally:
        page.set_viewport_size(before)


@pytest.mark.slow
def test_the_live_arm_moves(opened):
    see_the_arm_move(opened('03_publisher'))


@pytest.mark.slow
def test_a_dragged_slider_moves_the_arm(opened):
    lesson = opened('00_two_link_arm')
    lesson.command('notebook:run-cell', lesson.index('imports'))
    lesson.command('notebook:run-cell', lesson.index('sliders'))
    cell = lesson.shown('sliders')
    image = cell.locator('.jp-OutputArea img')
    expect(image).to_have_attribute('alt', re.compile('θ1 = 30.0°'))
    readout = drag_first_slider(lesson, cell, before='30')
    expect(image).to_have_attribute('alt', re.compile(f'θ1 = {readout}.0°'))


@pytest.mark.slow  # a slider of the same kind is dragged above
def test_a_dragged_target_moves_the_arm_over_the_topic(opened):
    lesson = opened('04_subscriber')
    lesson.command('notebook:run-cell', lesson.index('imports'))
    lesson.command('notebook:run-cell', lesson.index('drag'))
    cell = lesson.shown('drag')
    image = cell.locator('.jp-OutputArea img')
    before = image.get_attribute('src')
    drag_first_slider(lesson, cell, before='1.20')
    expect(image).not_to_have_attribute('src', before)


def drag_first_slider(lesson, cell, *, before):
    """Drag it to the right, away from the number that it shows; return what it shows then."""
    readout = cell.locator('.widget-readout').first
    expect(readout).to_have_text(before)
    handle = cell.locator('.noUi-handle').first
    handle.hover()
    lesson.page.mouse.down()
    lesson.page.mouse.move(handle.bounding_box()['x'] + 50, handle.bounding_box()['y'] + 5)
    lesson.page.mouse.up()
    expect(readout).not_to_have_text(before)
    return readout.inner_text()


@pytest.mark.slow
def test_validate_reports_a_wrong_answer_and_then_a_right_one(opened):
    lesson = opened('02_joint_state')
    lesson.type('to_joint_state', WRONG)
    said = lesson.validate()
    assert 'expected [0.5236, -1.5708] rad for (30.0, -90.0) degrees, saw [30.0, -90.0]' in said
    assert '✗ position holds both angles, in radians 0 of 2 points, more checks at grading' in said
    assert '✓ name holds joint1 and joint2, in this order 1 point ✓' in said
    assert said.count('Show the check') == 1
    assert 'def check_position' not in said  # folded away
    lesson.type('to_joint_state', RIGHT)
    said = lesson.validate()
    assert 'All visible checks pass. 3 of 4 points are decided at grading.' in said
    assert 'Success' not in said


@pytest.mark.slow
def test_validate_reports_in_the_language_of_the_lesson(opened):
    lesson = opened('02_joint_state', 'zh_CN')
    lesson.type('to_joint_state', WRONG)
    button = lesson.page.locator('jp-button', has_text='Validate')
    expect(button).to_have_attribute('title', '运行这一课中看得见的检查')
    said = lesson.validate('检查结果', '关闭')
    assert '预期：(30.0, -90.0) 度对应的 [0.5236, -1.5708] rad；实际：[30.0, -90.0]。' in said
    assert '✗ position 里是两个角度，以弧度为单位 0 / 2 分，评分时还有更多检查' in said
    assert '✓ name 里依次是 joint1 和 joint2 1 分 ✓' in said
    assert said.count('显示这项检查') == 1


WAITING = """\
        response = self.client.call(SolveIK.Request(target=target), timeout_sec=60.0)
        self.receive(response)

    def receive(self, response):
        if response.reachable:
            message = JointState(name=['joint1', 'joint2'], position=response.elbow_up)
"""


@pytest.mark.slow  # the dialog is the same, and the grader's tests have these answers
def test_validate_fails_only_the_client_that_waits_inside_a_callback(opened):
    lesson = opened('08_services')
    answers = {cell.id: cell.source for cell in solution('08_services').cells}
    lesson.type('ik_service', answers['ik_service'])
    head, _, rest = answers['ik_client'].partition('        future = ')
    lesson.type('ik_client', head + WAITING + rest[rest.index('            message.header') :])
    said = lesson.validate()
    assert '✗ The counter goes on while the server takes its time' in said
    assert 'called /solve_ik inside a callback and waited there' in said
    assert 'use call_async and add_done_callback' in said
    assert '✓ Each target within reach is answered with both branches, in radians' in said
    lesson.type('ik_client', answers['ik_client'])
    said = lesson.validate()
    assert 'All visible checks pass.' in said
    assert '✗' not in said


@pytest.mark.slow  # a kernel's test has its words, and the lesson's stored output its picture
def test_the_doctor_draws_where_a_service_is_broken(opened):
    lesson = opened('08_services')
    lesson.command('notebook:run-all-above', lesson.index('no_return'))
    lesson.command('notebook:run-cell', lesson.index('forgetful'))
    assert errors(lesson.cells) == {}
    outputs = lesson.shown('forgetful').locator('.jp-OutputArea')
    expect(outputs).to_contain_text('the callback returned no response')
    image = outputs.locator('img')
    expect(image).to_have_attribute('alt', re.compile('broken: /gripper'))
    assert image.evaluate(WIDTH) > 200


@pytest.mark.slow
def test_validate_shows_its_progress_and_stops_if_its_dialog_is_closed(lab, opened):
    lesson = opened('03_publisher')
    endless = 'class KinematicsPublisher(Node):\n    def __init__(self):\n        while True: pass'
    lesson.type('five_hz', endless)
    lesson.page.get_by_role('button', name='Validate').click()
    dialog = lesson.page.locator('.jp-Dialog', has_text='Validation Results')
    status = re.compile(r'five_hz: (running your cells|waiting for cell) ')
    expect(dialog.get_by_role('status')).to_have_text(status)
    lesson.command('docmanager:save')  # the server goes on with everything else
    (validating,) = validations(lab.server)
    dialog.get_by_role('button', name='Close').click()
    expect(dialog).to_have_count(0)
    assert validating.wait(LONG / 1000) is not None or not validating.is_running()
    expect(lesson.page.get_by_role('button', name='Validate')).to_be_enabled()


def validations(server):
    """The processes that validate for a JupyterLab."""
    below = psutil.Process(server.pid).children(recursive=True)
    return [p for p in below if 'my_robot_basics.validate' in p.cmdline()]


@pytest.mark.slow  # as in nbval, and in Validate
def test_a_right_answer_passes_when_run_in_jupyterlab(opened):
    lesson = opened('03_publisher')
    answer = next(c for c in solution('03_publisher').cells if c.id == 'five_hz')
    lesson.command('notebook:run-cell', lesson.index('imports'))
    lesson.type('five_hz', answer.source)
    lesson.command('notebook:run-all-below', lesson.index('five_hz-reset'))
    cells = lesson.cells
    assert errors(cells) == {}
    assert warnings(cells) == []
    graded = [c for c in cells if c.metadata.get('nbgrader', {}).get('grade')]
    assert all(cell.execution_count for cell in graded)


@pytest.mark.slow
def test_students_see_validate_and_no_panels_for_instructors(opened):
    page = opened('02_joint_state').page
    expect(page.get_by_role('button', name='Validate')).to_be_visible()
    for words in ['Nbgrader', 'Create Assignment', 'Jupyter news']:
        expect(page.get_by_text(words)).to_have_count(0)


def solution(name):
    return nbformat.read(ROOT / 'solutions' / name / f'{name}.ipynb', as_version=4)
