"""Use a hub with a browser only: log in, run code, fetch, submit, read feedback."""

import re
import shutil
from pathlib import Path

from chromium import LONG
from hub_machine import PASSWORD
from lab_browser import close_all
from playwright.sync_api import expect

START = """async () => {
    window.started = window.started || [];
    const kernel = await jupyterapp.serviceManager.kernels.startNew({name: 'python3'});
    return window.started.push(kernel) - 1;
}"""
RUN = """async ([number, code]) => {
    const future = window.started[number].requestExecute({code});
    let said = '';
    future.onIOPub = ({header, content}) => {
        if (header.msg_type === 'stream') said += content.text;
        if (header.msg_type === 'error') said += content.traceback.join('\\n');
    };
    return [(await future.done).content.status, said];
}"""
END_ALL = """async () => {
    for (const kernel of window.started || []) { await kernel.shutdown(); kernel.dispose(); }
    window.started = [];
}"""


def log_in(browser, machine, name):
    """Log in with the password on this machine, in a new browser context; return the page."""
    # a setting in the user's home lets the test control JupyterLab in the page
    settings = Path('/home', name, '.jupyter/jupyter_lab_config.json')
    settings.parent.mkdir()
    settings.write_text('{"LabApp": {"expose_app_in_browser": true}}', encoding='utf-8')
    for made in (settings.parent, settings):
        shutil.chown(made, name, name)
    context = browser.new_context(viewport={'width': 1200, 'height': 900})
    context.set_default_timeout(LONG)
    page = context.new_page()
    page.goto(machine.address)
    page.get_by_label('Username').fill(name)
    page.get_by_label('Password').fill(PASSWORD)
    page.get_by_role('button', name='Sign in').click()
    return page


def wait_for_lab(page):
    """Wait until JupyterLab has started and can be controlled by the test."""
    page.wait_for_function('window.jupyterapp?.restored.then(() => true)')


class Kernel:
    """A kernel that a student starts in JupyterLab, to run any code."""

    def __init__(self, page):
        self.page = page
        self.number = page.evaluate(START)

    def run(self, code):
        """Run code to its end; return its output."""
        status, said = self.page.evaluate(RUN, [self.number, code])
        assert status == 'ok', said
        return said


def end_kernels(page):
    """Shut down the kernels that `Kernel` has started in a page."""
    page.evaluate(END_ALL)


class AssignmentList:
    """JupyterLab's panel Assignment List."""

    def __init__(self, page):
        self.page = page
        page.get_by_role('menuitem', name='Nbgrader').click()
        page.get_by_role('menuitem', name='Assignment List').click()

    def row(self, state, lesson):
        """Return the row of a lesson that was `released`, `fetched` or `submitted`."""
        return self.page.locator(f'#{state}_assignments_list > .list_item', has_text=lesson)

    def press(self, state, lesson, name):
        """Press a button in a row."""
        self.row(state, lesson).get_by_role('button', name=name, exact=True).click()

    def fetch(self, lesson):
        """Fetch a lesson, and wait until it is listed as fetched."""
        self.press('released', lesson, 'Fetch')
        expect(self.row('fetched', lesson)).to_be_visible()

    def submit(self, lesson):
        """Submit a lesson, and wait until it is listed as submitted."""
        self.press('fetched', lesson, 'Submit')
        expect(self.row('submitted', lesson)).to_be_visible()

    def open_feedback(self, lesson):
        """Fetch the feedback of the last submission, and open its page; return its text."""
        self.press('submitted', lesson, 'Fetch Feedback')
        self.row('submitted', lesson).get_by_text('(view feedback)').first.click()
        self.page.locator('.jp-DirListing-item', has_text=f'{lesson}.html').dblclick()
        body = self.page.frame_locator('.jp-HTMLViewer iframe').locator('body')
        expect(body).to_contain_text(lesson)
        said = ' '.join(body.inner_text().split())
        close_all(self.page)
        return said


def answer(lesson, cell_id, text):
    """Write an answer, and save the notebook."""
    lesson.page.evaluate(
        """async ([index, text]) => {
            const {content, context} = jupyterapp.shell.currentWidget;
            content.widgets[index].model.sharedModel.setSource(text);
            await context.save();
        }""",
        [lesson.index(cell_id), text],
    )


def open_formgrader(page):
    """Open the formgrader from the menu, as docs/for-instructors.md says; return its frame."""
    page.get_by_role('menuitem', name='Nbgrader').click()
    page.get_by_role('menuitem', name='Formgrader').click()
    return page.frame_locator('iframe[src*="formgrader"]')


def score_by_hand(formgrader, lesson, cell_id, points):
    """Give points for each student's text answer, in the formgrader.

    `points` has, by a part of the text, its points and the comment.
    """
    for number in range(1, len(points) + 1):
        formgrader.get_by_role('link', name='Manual Grading').first.click()
        for crumb in (lesson, lesson):  # the assignment, then its notebook
            formgrader.locator('td a', has_text=crumb).click()
            expect(formgrader.locator('.breadcrumb li', has_text=crumb).last).to_be_visible()
        formgrader.locator('td a', has_text=f'Submission #{number}').click()
        score = formgrader.locator(f'input.score#{cell_id}')
        expect(score).to_have_class(re.compile('needs_manual_grade'))
        text = formgrader.locator('body').inner_text()
        [(earned, comment)] = [given for words, given in points.items() if words in text]
        for field, value, api in (
            (score, earned, 'grade'),
            (formgrader.locator(f'textarea#{cell_id}-comment'), comment, 'comment'),
        ):
            field.fill(value)
            page = field.page
            with page.expect_response(lambda reply, api=api: f'/api/{api}/' in reply.url) as saved:
                field.press('Tab')
            assert saved.value.ok
