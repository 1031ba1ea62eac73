"""JupyterLab of `./course lab`, and a lesson in it, for tests with a browser."""

import json
import re
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

import nbformat
from answered import students_environment
from chromium import LONG
from playwright.sync_api import expect

ROOT = Path(__file__).parents[1]
LESSONS = sorted(path.stem for path in ROOT.glob('notebooks/[0-9]*/*.ipynb'))
TOKEN = 'a-token-of-this-test'
ALL_RAN = """() => {
    const {content, sessionContext} = jupyterapp.shell.currentWidget;
    const code = content.model.toJSON().cells.filter(cell => cell.cell_type === 'code');
    return code.every(cell => cell.execution_count !== null)
        && sessionContext.session.kernel.status === 'idle';
}"""
WIDTH = 'async image => (await image.decode(), image.naturalWidth)'


class Lab:
    """A JupyterLab of `./course lab`, with copies of the released lessons."""

    def __init__(self, folder, *arguments):
        self.folder = folder / 'notebooks'
        self.folder.mkdir()
        with socket.socket() as free:
            free.bind(('127.0.0.1', 0))
            self.address = f'http://127.0.0.1:{free.getsockname()[1]}'
        # without settings of this user's own JupyterLab, or of the test session
        names = ['CONFIG', 'DATA', 'RUNTIME']
        mine = {f'JUPYTER_{name}_DIR': str(folder / name) for name in names}
        options = ['--no-browser', '--expose-app-in-browser', '--ServerApp.port_retries=0']
        options += [
            f'--port={self.address.rpartition(":")[2]}',
            f'--IdentityProvider.token={TOKEN}',
        ]
        self.log = folder / 'log'
        with self.log.open('w') as log:
            self.server = subprocess.Popen(
                [ROOT / 'course', 'lab', self.folder, *options, *arguments],
                env=students_environment() | mine,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            )

    def wait_until_up(self):
        deadline = time.monotonic() + LONG / 1000
        while True:
            try:
                return urllib.request.urlopen(f'{self.address}/api/status?token={TOKEN}').close()
            except urllib.error.URLError:
                assert self.server.poll() is None, self.log.read_text()
                assert time.monotonic() < deadline, self.log.read_text()
                time.sleep(0.2)

    def fresh_copy(self, name, language=''):
        """Copy a released lesson that was never opened, so it has no kernel; return its path."""
        folder = Path(tempfile.mkdtemp(dir=self.folder))
        shutil.copy(ROOT / 'notebooks' / language / name / f'{name}.ipynb', folder)
        return f'{folder.name}/{name}.ipynb'

    def stop(self):
        self.server.terminate()
        try:
            self.server.wait(30)
        except subprocess.TimeoutExpired:
            self.server.kill()
            self.server.wait()


def wait_until_open(page, path):
    """Wait until a notebook is in front and its kernel is idle."""
    page.wait_for_function(f"""
        jupyterapp.shell.currentWidget?.context?.path === '{path}'
        && jupyterapp.shell.currentWidget.context.isReady
        && jupyterapp.shell.currentWidget.sessionContext.session?.kernel?.status === 'idle'
    """)


class Lesson:
    """One lesson, open in a browser."""

    def __init__(self, page, path):
        self.page = page
        page.evaluate(  # does what a double click does
            "async path => { await jupyterapp.commands.execute('docmanager:open', {path}) }", path
        )
        wait_until_open(page, path)

    def command(self, name, index=None):
        """Run a command of JupyterLab's menus, with a cell selected; wait until it has ended."""
        self.page.evaluate(
            """async ([name, index]) => {
                if (index !== null)
                    jupyterapp.shell.currentWidget.content.activeCellIndex = index;
                await jupyterapp.commands.execute(name);
            }""",
            [name, index],
        )

    @property
    def cells(self):
        notebook = 'JSON.stringify(jupyterapp.shell.currentWidget.content.model.toJSON())'
        return nbformat.from_dict(json.loads(self.page.evaluate(notebook))).cells

    def index(self, cell_id):
        return [cell.id for cell in self.cells].index(cell_id)

    def shown(self, cell_id):
        """Scroll to a cell, and return it."""
        index = self.index(cell_id)
        self.page.evaluate('i => jupyterapp.shell.currentWidget.content.scrollToItem(i)', index)
        cell = self.page.locator(f'.jp-Notebook .jp-Cell[data-windowed-list-index="{index}"]')
        cell.scroll_into_view_if_needed()
        return cell

    def type(self, cell_id, text):
        """Replace a cell's text by keyboard input."""
        self.shown(cell_id).locator('.cm-content').click()
        self.page.keyboard.press('Control+A')
        self.page.keyboard.insert_text(text)

    def validate(self, title='Validation Results', close='Close'):
        """Press the button Validate; return the text of the final dialog."""
        self.page.get_by_role('button', name='Validate').click()
        dialog = self.page.locator('.jp-Dialog', has=self.page.locator('.mrb-validate-report'))
        dialog.locator('.mrb-validate-summary').wait_for()
        expect(dialog.locator('.jp-Dialog-header')).to_have_text(title)
        said = dialog.inner_text()
        dialog.get_by_role('button', name=close).click()
        expect(dialog).to_have_count(0)
        return ' '.join(said.split())


def close_all(page):
    """Shut down all kernels, and close all open documents."""
    page.evaluate("""async () => {
        await jupyterapp.serviceManager.sessions.shutdownAll();
        [...jupyterapp.shell.widgets('main')].forEach(widget => widget.dispose());
    }""")


def errors(cells):
    return {
        cell.id: re.sub(r'\x1b\[[\d;]*m', '', '\n'.join(output.traceback))
        for cell in cells
        for output in cell.get('outputs', [])
        if output.output_type == 'error'
    }


def pictures(cell):
    """Return the stored outputs that have a picture."""
    return [o for o in cell.get('outputs', []) if 'image/png' in o.get('data', {})]


def warnings(cells):
    return [o for c in cells for o in c.get('outputs', []) if o.get('name') == 'stderr']


def run_through(lesson):
    """Run all cells of an unanswered lesson: checks don't stop it, and every picture is shown."""
    released = lesson.cells
    # cells that may fail: checks, and cells that run an answer, such as the commands of lesson 11
    stops = [c.id for c in released if 'raises-exception' in c.metadata.get('tags', ())]
    lesson.command('notebook:run-all-cells')
    # the command waits only for the first error; a whole lesson takes longer than an action
    lesson.page.wait_for_function(ALL_RAN, timeout=3 * LONG)
    cells = lesson.cells
    failed = errors(cells)
    assert failed
    assert {name: why for name, why in failed.items() if name not in stops} == {}
    assert warnings(cells) == []
    for cell in released:
        if count := len(pictures(cell)):
            images = lesson.shown(cell.id).locator('.jp-OutputArea img')
            expect(images).to_have_count(count)
            for image in images.all():
                assert image.evaluate(WIDTH) > 200


def see_the_arm_move(lesson):
    """Run the cells of lesson 3 that show the arm, and check that the picture changes."""
    lesson.command('notebook:run-cell', lesson.index('imports'))
    lesson.command('notebook:run-cell', lesson.index('live'))
    assert errors(lesson.cells) == {}
    image = lesson.shown('live').locator('.jp-OutputArea img')
    for _ in range(2):  # the first change may only replace the stored picture
        before = image.get_attribute('src')
        expect(image).not_to_have_attribute('src', before)
