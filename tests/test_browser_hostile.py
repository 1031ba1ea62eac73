"""A hostile submission in the instructor's browser is shown, and runs nothing."""

import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from datetime import datetime
from urllib.parse import quote

import pytest
from chromium import drives_chromium, launched
from course_maker import TOY, answered, executed, make_course, submit, toy_lesson, write_source
from my_robot_basics.validate.kernels.outputs import CellRun
from nbformat.v4 import new_output
from nbgrader.api import Gradebook

from grader.authoring.release import release
from grader.grading import SubmissionOutcome
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.report.feedback import write_feedback
from grader.report.report import Run, write_report
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register
from grader.storage.submitted import find_submissions

TOKEN = 'a-token-of-this-test'
TIMEOUT_SEC = 120

pytestmark = drives_chromium

ELSEWHERE = 'evil.invalid'
OWN_SERVER = '/user/eve/plot'
"""A page of a student's server on a hub: it may do what the person who opens it may do."""
BY_NAME = '<img src=x onerror=alert(1)>'
STUDENT = "'-alert(1)-'&lt;{{7*7}}"
"""A name that a folder can have; a folder named BY_NAME is not graded."""
EVIL = (
    f'evil <script>alert(1)</script>{BY_NAME}<svg onload=alert(1)></svg>'
    '<iframe srcdoc="<script>parent.alert(1)</script>"></iframe>'
    '<a href="javascript:alert(1)">x</a><style onload=alert(1)>*{}</style>'
    f'<a href="{OWN_SERVER}">x</a>'
    f'<math><mtext><mglyph><style><img src=x onerror=alert(1)></style></mtext></math>'
    f'<object data="javascript:alert(1)"></object><link rel=stylesheet href="//{ELSEWHERE}/x">'
)
SVG = (
    f'<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)">'
    f'<script>alert(1)</script>{EVIL}</svg>'
)
VIEW = 'application/vnd.jupyter.widget-view+json'
STATE = 'application/vnd.jupyter.widget-state+json'
MODEL = {
    'model_name': 'HTMLModel',
    'model_module': '@jupyter-widgets/controls',
    'model_module_version': '2.0.0',
    'state': {'value': EVIL},
}
OUTPUTS = [
    new_output('stream', text=EVIL),
    new_output('stream', name='stderr', text=f'\x1b[31m{EVIL}\x1b]8;;javascript:alert(1)\x07x'),
    new_output('display_data', {'text/html': EVIL, 'text/plain': EVIL}),
    new_output('display_data', {'image/svg+xml': SVG}),
    new_output('display_data', {'application/javascript': 'alert(1)', 'text/plain': EVIL}),
    new_output('display_data', {'text/markdown': f'{EVIL} [x](javascript:alert(1))'}),
    new_output('display_data', {'text/latex': f'$\\href{{javascript:alert(1)}}{{x}}$ {EVIL}'}),
    new_output('display_data', {'image/png': f'"><script>{EVIL}'}),
    new_output(
        'display_data',
        {'image/png': 'AAAA', 'text/plain': EVIL},
        metadata={'image/png': {'width': 5, 'alt': f'">{EVIL}'}},
    ),
    new_output('display_data', {VIEW: '{"model_id": "0"}', EVIL: EVIL, 'text/plain': EVIL}),
    new_output('error', ename=EVIL, evalue=EVIL, traceback=[EVIL]),
]


class Browser:
    """A page that writes down what it was made to do."""

    def __init__(self, page):
        self.page, self.harm = page, []
        page.set_default_timeout(TIMEOUT_SEC * 1000)
        page.on('dialog', self._dialog)
        page.route('**/*', self._request)

    def _dialog(self, dialog):
        self.harm.append(f'ran: {dialog.message}')
        dialog.dismiss()

    def _request(self, route):
        if ELSEWHERE in route.request.url:
            self.harm.append(f'asked for {route.request.url}')
        if '127.0.0.1' in route.request.url or route.request.url.startswith(('file:', 'data:')):
            route.continue_()
        else:
            route.abort()  # no test here needs the internet

    def harm_of(self, address):
        """Open a page; return what it did, and what it would do when touched."""
        self.harm.clear()
        self.page.goto(address)
        self.page.wait_for_load_state('networkidle')
        waiting = self.page.evaluate(
            """server => [...document.querySelectorAll('*')].flatMap(each =>
            [...each.attributes].filter(a => /^\\s*javascript:(?!void)/i.test(a.value)
                || (a.name.startsWith('on') && a.value.includes('alert(1)'))
                || (a.name == 'href' && a.value.includes(server))
            ).map(a => `${each.tagName} ${a.name}=${a.value}`))""",
            OWN_SERVER,
        )
        return self.harm + waiting

    def text(self):
        return self.page.evaluate('document.documentElement.innerHTML')


@pytest.fixture(scope='module')
def browser():
    with launched() as chromium:
        yield Browser(chromium.new_page())


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    """One hostile submission, graded, stored and reported."""
    course = make_course(tmp_path_factory.mktemp('hostile'))
    lesson = toy_lesson()
    del lesson.metadata['widgets']  # the state of no widget at all
    write_source(course, lesson)
    release(course)
    register(course, TOY)
    notebook = answered(
        course, f'# {EVIL}', explained=f'{EVIL} [x](javascript:alert(1)) [x]({OWN_SERVER}) ![y](z)'
    )
    notebook.metadata['widgets'] = {STATE: {'version_major': 2, 'state': {'0': MODEL}}}
    notebook.metadata['title'] = EVIL
    for cell in notebook.cells:
        if cell.cell_type == 'markdown':
            cell['attachments'] = {f'">{BY_NAME}': {'image/svg+xml': SVG}}
    submit(course, BY_NAME, notebook)
    assert all(each.problem for each in find_submissions(course))
    path = submit(course, STUDENT, notebook)
    (path.parent / f'{BY_NAME}.py').write_text('x = 1')
    folder = course.folder('submitted', STUDENT, TOY)
    submission = read_submission(folder, student_id=STUDENT, assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    said = f'expected {EVIL}, saw {EVIL}: {EVIL}'
    graded = executed(
        sanitize_restored(course, TOY, restored), {'double-check': said, 'double-hidden': '?'}
    )
    run = CellRun()
    for output in OUTPUTS:
        run.keep(output.output_type, output)
    for cell in graded.cells:
        if cell.cell_type == 'code' and not cell.metadata.get('nbgrader', {}).get('grade'):
            cell.outputs = run.outputs
        elif cell.id == 'double-check':
            cell.outputs = [*run.outputs[:-1], *cell.outputs]
    store(course, submission, graded)
    return course


@pytest.fixture(scope='module')
def formgrader(course):
    """The address of the formgrader, as an instructor starts it in the course's folder."""
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    address, log = f'http://127.0.0.1:{port}', course.root / 'server.log'
    folders = {f'JUPYTER_{n}_DIR': str(course.root / n) for n in ('CONFIG', 'DATA', 'RUNTIME')}
    path = os.pathsep.join([str(sys.prefix) + '/bin', os.environ['PATH']])
    options = [f'--port={port}', '--ServerApp.port_retries=0', f'--IdentityProvider.token={TOKEN}']
    with log.open('w') as said:
        server = subprocess.Popen(
            [sys.executable, '-m', 'jupyter_server', '--no-browser', '--allow-root', *options],
            cwd=course.root,
            env=os.environ | folders | {'PATH': path},
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
        )
    try:
        deadline = time.monotonic() + TIMEOUT_SEC
        while True:
            try:
                urllib.request.urlopen(f'{address}/api/status?token={TOKEN}').close()
                break
            except urllib.error.URLError:
                assert server.poll() is None, log.read_text()
                assert time.monotonic() < deadline, log.read_text()
                time.sleep(0.2)
        yield f'{address}/formgrader'
    finally:
        server.terminate()
        server.communicate()


@pytest.mark.slow
def test_an_unescaped_page_is_seen_to_do_harm(browser, tmp_path):
    page = tmp_path / 'page.html'
    page.write_text(f'<!doctype html><body>{EVIL}{SVG}')
    harm = browser.harm_of(page.as_uri())
    assert {'ran: 1', f'asked for file://{ELSEWHERE}/x'} <= set(harm)
    assert any('href=javascript' in each for each in harm)


def test_a_page_of_feedback_runs_no_hostile_code(browser, course):
    (page,) = write_feedback(course)
    assert browser.harm_of(page.as_uri()) == []
    assert 'evil &lt;script&gt;' in browser.text()  # the text is shown


def test_the_report_of_a_run_runs_no_hostile_code(browser, course):
    rows = [
        SubmissionOutcome(BY_NAME, TOY, None, f'{EVIL} <{BY_NAME}', 1.0),
        SubmissionOutcome(EVIL, EVIL, None, EVIL),
    ]
    page = write_report(course, Run(datetime.now().astimezone(), seed=''), rows)
    assert browser.harm_of(page.as_uri()) == []
    assert 'evil &lt;script&gt;' in browser.text()


@pytest.mark.slow
def test_the_formgrader_runs_no_hostile_code(browser, course, formgrader):
    with Gradebook(course.db_url) as gradebook:
        (submission,) = gradebook.notebook_submissions(TOY, TOY)
        number = submission.id
    browser.harm_of(f'{formgrader}?token={TOKEN}')  # signed in from here on
    assert browser.harm_of(f'{formgrader}/submissions/{number}/') == []
    assert 'evil <script>' in browser.page.locator('body').inner_text()
    for view in (
        f'manage_submissions/{TOY}',
        'manage_students',
        f'manage_students/{quote(STUDENT, safe="")}',
        f'manage_students/{quote(STUDENT, safe="")}/{TOY}',
        f'gradebook/{TOY}',
        f'gradebook/{TOY}/{TOY}',
        'manage_assignments',
    ):
        assert browser.harm_of(f'{formgrader}/{view}') == [], view
        assert 'encountered an error' not in browser.text(), view
