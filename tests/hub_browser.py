"""What somebody does on a hub with a browser alone: log in, run code, fetch, submit, read."""

import shutil
from pathlib import Path

from chromium import LONG
from hub_machine import PASSWORD

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
    """Log in with the password on this machine, in a new browser; return the page."""
    # what is in the page may be driven from it: a user's own setting, in their own home
    settings = Path('/home', name, '.jupyter/jupyter_lab_config.json')
    settings.parent.mkdir()
    settings.write_text('{"LabApp": {"expose_app_in_browser": true}}', encoding='utf-8')
    for made in (settings.parent, settings):
        shutil.chown(made, name, name)
    page = browser.new_page(viewport={'width': 1200, 'height': 900})
    page.set_default_timeout(LONG)
    page.goto(machine.address)
    page.get_by_label('Username').fill(name)
    page.get_by_label('Password').fill(PASSWORD)
    page.get_by_role('button', name='Sign in').click()
    return page


def wait_for_lab(page):
    """Wait until JupyterLab has come up, and is open to tests."""
    page.wait_for_function('window.jupyterapp?.restored.then(() => true)')


class Kernel:
    """A kernel of a student's own, begun in their JupyterLab: what runs where, they decide."""

    def __init__(self, page):
        self.page = page
        self.number = page.evaluate(START)

    def run(self, code):
        """Run code to its end; return what it said."""
        status, said = self.page.evaluate(RUN, [self.number, code])
        assert status == 'ok', said
        return said


def end_kernels(page):
    """End what `Kernel` has begun in a page."""
    page.evaluate(END_ALL)
