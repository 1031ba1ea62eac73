"""A written answer of lesson 5, read and scored in the formgrader, in a real browser."""

import csv
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

import nbformat
import pytest
from chromium import LONG, drives_chromium, launched
from course_maker import executed
from playwright.sync_api import expect
from sample_class import FOLDER
from stand_in import stand_in

from grader.__main__ import main
from grader.course import ROOT, Course
from grader.judging.execute import Execution
from grader.storage import reuse

LESSON, ANSWER = '05_command_line', 'explain_counts'
SAMPLE = '05_command_line-pass-typed_with_slashes'
COMMENT = 'Right. Which node is it?'
TOKEN = 'a-token-of-this-test'

pytestmark = drives_chromium


@pytest.fixture
def course(tmp_path, monkeypatch):
    """Lesson 5 and what Ada handed in; her answers count as right without being run."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        return Execution(notebook=executed(notebook, {}), verdicts=(), notes=())

    stand_in(look, monkeypatch)
    monkeypatch.setattr(reuse, 'software_hash', lambda: 'the same code')  # hashing it takes long
    course = Course.at(tmp_path / 'course')
    for part in ('solutions', 'notebooks'):
        shutil.copytree(ROOT / part / LESSON, course.root / part / LESSON)
    shutil.copy(ROOT / 'nbgrader_config.py', course.root)
    folder = course.folder('submitted', 'ada', LESSON)
    folder.mkdir(parents=True)
    shutil.copy(FOLDER / 'more' / f'{SAMPLE}.ipynb', folder / f'{LESSON}.ipynb')
    return course


@pytest.fixture
def lab(course, tmp_path):
    """`.venv/bin/jupyter lab` in the course's folder, as docs/for-instructors.md says.

    Gives its address.
    """
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    # neither what this user's own JupyterLab remembers, nor what a test session sets
    mine = {f'JUPYTER_{name}_DIR': str(tmp_path / name) for name in ('CONFIG', 'DATA', 'RUNTIME')}
    clean = {k: v for k, v in os.environ.items() if not k.startswith(('PYTEST_', 'COV_'))}
    clean['PYTHONPATH'] = str(course.root)  # as that of a checkout is in its .venv
    with (tmp_path / 'log').open('w') as log:
        server = subprocess.Popen(
            [
                *(Path(sys.executable).with_name('jupyter'), 'lab', '--no-browser'),
                *('--allow-root', f'--port={port}', '--ServerApp.port_retries=0'),
                f'--IdentityProvider.token={TOKEN}',
            ],
            cwd=course.root,
            env=clean | mine,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
    address = f'http://127.0.0.1:{port}'
    try:
        deadline = time.monotonic() + LONG / 1000
        while True:
            try:
                urllib.request.urlopen(f'{address}/api/status?token={TOKEN}').close()
                break
            except urllib.error.URLError:
                assert server.poll() is None, (tmp_path / 'log').read_text()
                assert time.monotonic() < deadline, (tmp_path / 'log').read_text()
                time.sleep(0.2)
        yield address
    finally:
        server.terminate()
        server.wait(30)


def told(capsys, course, *arguments):
    capsys.readouterr()
    assert main(list(arguments), course=course) == 0
    return capsys.readouterr().out


def exported(capsys, course):
    """Score and comment of the written answer in the table of scores."""
    told(capsys, course, 'scores')
    with (course.gradebook / 'scores.csv').open(encoding='utf-8-sig', newline='') as file:
        [row] = [row for row in csv.DictReader(file) if row['grade_id'] == ANSWER]
    return row['score'], row['comment']


@pytest.mark.slow
def test_the_formgrader_runs_nothing_in_a_folder_that_an_address_names(course, lab):
    """A picture in a collected notebook, ![](/formgrader?path=…), calls such an address."""
    folder, ran = course.folder('submitted', 'ada', LESSON), course.root / 'ran'
    (folder / 'nbgrader_config.py').write_text(f'open({str(ran)!r}, "w")')
    address = f'{lab}/formgrader?token={TOKEN}&path='
    for path in (folder, folder.relative_to(course.root)):
        with pytest.raises(urllib.error.HTTPError, match='403'):
            urllib.request.urlopen(f'{address}{path}')
    urllib.request.urlopen(f'{address}{course.root}').close()
    assert not ran.exists()


@pytest.mark.slow
def test_no_export_imports_what_a_notebook_names(course, lab):
    """A picture in the notebook, ![](/nbconvert/script/…), begins an export, too."""
    folder, ran = course.folder('submitted', 'ada', LESSON), course.root / 'ran'
    (folder / 'evil.py').write_text(f'open({str(ran)!r}, "w")')
    work = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell('1 + 1')])
    module = '.'.join(folder.relative_to(course.root).parts)
    work.metadata.language_info = {'name': 'python', 'nbconvert_exporter': f'{module}.evil.X'}
    nbformat.write(work, folder / f'{LESSON}.ipynb')
    path = (folder / f'{LESSON}.ipynb').relative_to(course.root)
    with urllib.request.urlopen(f'{lab}/nbconvert/script/{path}?token={TOKEN}') as reply:
        assert b'1 + 1' in reply.read()
    assert not ran.exists()


@pytest.mark.slow
@pytest.mark.parametrize('page', ['manage_submissions', 'gradebook', 'manage_students'])
def test_a_name_in_an_address_of_the_formgrader_is_shown_as_text(lab, page):
    """A link to such an address would do anything in the name of whoever follows it."""
    for script in ('</script><script>alert(1)</script>', '";alert(1)//', '\\x3cimg src=x>'):
        address = f'{lab}/formgrader/{page}/{urllib.parse.quote(script, safe="")}?token={TOKEN}'
        with urllib.request.urlopen(address) as reply:
            shown = reply.read().decode()
        assert 'alert(1)' in shown or 'x3cimg' in shown
        assert script not in shown


@pytest.mark.slow
def test_points_and_a_comment_given_in_the_formgrader_stay_when_ada_is_graded_again(
    course, lab, capsys
):
    assert re.search(r'^ada .* 2/4 … ', told(capsys, course, 'grade'), re.MULTILINE)
    assert exported(capsys, course) == ('', 'to be graded by hand')
    with launched() as browser:
        page = browser.new_page()
        page.set_default_timeout(LONG)
        page.goto(f'{lab}/lab?token={TOKEN}&reset')
        page.get_by_role('menuitem', name='Nbgrader').click()
        page.get_by_role('menuitem', name='Formgrader').click()
        formgrader = page.frame_locator('iframe[src*="formgrader"]')
        formgrader.get_by_role('link', name='Manual Grading').first.click()
        for _ in ('the assignment', 'its notebook'):
            formgrader.locator('td a', has_text=LESSON).click()
            expect(formgrader.locator('.breadcrumb li', has_text=LESSON).last).to_be_visible()
        formgrader.locator('td a', has_text='Submission #1').click()

        written = nbformat.read(FOLDER / 'more' / f'{SAMPLE}.ipynb', as_version=4)
        [text] = [cell.source for cell in written.cells if cell.id == ANSWER]
        expect(formgrader.locator('body')).to_contain_text(' '.join(text.split()[:4]))
        score = formgrader.locator(f'input.score#{ANSWER}')
        expect(score).to_have_class(re.compile('needs_manual_grade'))
        for field, value, api in (
            (score, '1.5', 'grade'),
            (formgrader.locator(f'textarea#{ANSWER}-comment'), COMMENT, 'comment'),
        ):
            field.fill(value)
            with page.expect_response(lambda reply, api=api: f'/api/{api}/' in reply.url) as saved:
                field.press('Tab')
            assert saved.value.ok
    assert exported(capsys, course) == ('1.5', f'scored by hand; {COMMENT}')

    for again in (['grade'], ['grade', '--force'], ['grade', LESSON]):
        assert re.search(r'^ada .* 3.5/4( |$)', told(capsys, course, *again), re.MULTILINE)
        assert exported(capsys, course) == ('1.5', f'scored by hand; {COMMENT}')
    told(capsys, course, 'feedback')
    [html] = course.gradebook.glob(f'feedback/ada/*/{LESSON}.html')
    assert COMMENT in html.read_text(encoding='utf-8')
