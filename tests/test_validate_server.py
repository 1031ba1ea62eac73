"""The address behind the Validate button sends lines as they come, and blocks no other request."""

import json
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.parse
import urllib.request

import psutil
import pytest
from answered import ROOT, answered, students_environment

TOKEN = 'a-token-of-this-test'
LONG_SEC = 120.0


class Server:
    """A Jupyter server with the extension, for one folder."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(('127.0.0.1', 0))
            port = free.getsockname()[1]
        self.address = f'http://127.0.0.1:{port}'
        clean = students_environment()
        mine = {f'JUPYTER_{n}_DIR': str(folder.parent / n) for n in ('CONFIG', 'DATA', 'RUNTIME')}
        options = ['--ServerApp.port_retries=0', '--allow-root', '--no-browser']
        options += [f'--ServerApp.port={port}', f'--IdentityProvider.token={TOKEN}']
        options += [f'--ServerApp.root_dir={folder}']
        self.process = subprocess.Popen(
            [sys.executable, '-P', '-m', 'jupyter_server', *options],
            env=clean | mine,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def ask(self, path, data=None, token=TOKEN):
        headers = {'Authorization': f'token {token}', 'Content-Type': 'application/json'}
        request = urllib.request.Request(f'{self.address}/{path}', data, headers)
        return urllib.request.urlopen(request, timeout=LONG_SEC)

    def progress(self, path, **options):
        return self.ask(f'my_robot_basics/progress?path={urllib.parse.quote(path)}', **options)

    def validate(self, path, **options):
        return self.ask('my_robot_basics/validate', json.dumps({'path': path}).encode(), **options)

    def wait_until_up(self):
        deadline = time.monotonic() + LONG_SEC
        while True:
            try:
                return self.ask('api/status').close()
            except urllib.error.URLError:
                assert self.process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.2)

    def validations(self):
        below = psutil.Process(self.process.pid).children(recursive=True)
        return [p for p in below if 'my_robot_basics.validate' in p.cmdline()]


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp('served') / 'notebooks'


@pytest.fixture(scope='module')
def server(folder):
    answered('02_joint_state', folder)
    answered('03_publisher', folder, five_hz='import time\nwhile True: time.sleep(1)')
    server = Server(folder)
    try:
        server.wait_until_up()
        yield server
    finally:
        server.process.terminate()
        server.process.wait(30)


def test_the_button_has_texts_in_the_language_of_its_notebook(server, folder):
    english = json.loads((folder / '02_joint_state.ipynb').read_text(encoding='utf-8'))
    english['metadata'].setdefault('my_robot_basics', {})['language'] = 'zh_CN'
    (folder / 'chinese.ipynb').write_text(json.dumps(english), encoding='utf-8')
    shown = {
        path: json.load(server.ask(f'my_robot_basics/validate?path={path}'))['words']
        for path in ('02_joint_state.ipynb', 'chinese.ipynb', 'nothing.ipynb')
    }
    about = 'Run the visible checks of this lesson'
    assert shown['02_joint_state.ipynb'][about] == about
    assert shown['chinese.ipynb'][about] == '运行这一课中看得见的检查'
    assert shown['nothing.ipynb'] == {}
    with pytest.raises(urllib.error.HTTPError) as refused:
        server.ask('my_robot_basics/validate?path=../secret.ipynb')
    assert refused.value.code == 403


def test_a_report_comes_at_the_end_of_lines_of_progress(server):
    with server.validate('02_joint_state.ipynb') as response:
        assert response.headers['Content-Type'] == 'application/x-ndjson'
        *progress, last = map(json.loads, response)
    assert progress[0] == {'progress': 'to_joint_state: starting two kernels'}
    assert last['report']['summary'].startswith('All visible checks pass.')


@pytest.mark.slow
def test_the_server_answers_while_validating_and_closing_the_dialog_ends_validate(server):
    response = server.validate('03_publisher.ipynb')
    assert b'starting two kernels' in response.readline()
    assert b'running your cells' in response.readline()
    with server.ask('api/status') as status:
        assert status.status == 200
    (validating,) = server.validations()
    begun = [validating, *validating.children(recursive=True)]
    assert len(begun) >= 3
    response.close()
    _, alive = psutil.wait_procs(begun, timeout=LONG_SEC)
    assert alive == []
    assert server.validations() == []


REFUSED = {
    'no such file': ('nothing.ipynb', 'cannot be read: No such file'),
    'a folder': ('', 'cannot be read: Is a directory'),
}


@pytest.mark.parametrize(('path', 'said'), REFUSED.values(), ids=REFUSED)
def test_a_path_without_a_notebook_is_refused_in_a_sentence(server, path, said):
    with server.validate(path) as response:
        (line,) = map(json.loads, response)
    assert said in line['failed']


@pytest.mark.parametrize(
    ('path', 'token', 'code'),
    [('../secret.ipynb', TOKEN, 403), ('02_joint_state.ipynb', 'another', 403)],
)
def test_validating_outside_the_folder_or_with_a_wrong_token_is_forbidden(
    server, path, token, code
):
    with pytest.raises(urllib.error.HTTPError) as refused:
        server.validate(path, token=token)
    assert refused.value.code == code


@pytest.mark.slow
def test_the_error_is_reported_if_validate_itself_fails(server, folder):
    broken = json.loads((folder / '02_joint_state.ipynb').read_text())
    for cell in broken['cells']:
        cell['metadata'].get('nbgrader', {})['points'] = 'many'
    (folder / 'broken.ipynb').write_text(json.dumps(broken))
    with server.validate('broken.ipynb') as response:
        *_, line = map(json.loads, response)
    assert line['failed'].startswith('Validate itself failed: ValueError: could not convert')


@pytest.mark.slow
def test_progress_shows_the_exercises_that_have_passed_in_validate(server, folder):
    shutil.copy(ROOT / 'notebooks/index.ipynb', folder)
    answered('01_topics', folder / '01_topics')

    def states():
        with server.progress('index.ipynb') as response:
            told = json.load(response)
        exercises = [each for lesson in told['lessons'] for each in lesson['exercises']]
        return told, {each['name']: each['state'] for each in exercises}

    told, before = states()
    assert before['predict_delivery'] == 'open'
    assert told['lessons'][1]['path'] == '01_topics/01_topics.ipynb'
    with server.validate('01_topics/01_topics.ipynb') as response:
        *_, last = map(json.loads, response)
    assert last['report']['notes'] == []
    told, after = states()
    assert after['predict_delivery'] == 'passed'
    assert told['notes'] == []
    kept = folder.parent / 'DATA/my_robot_basics/passed_answers.json'
    kept.write_text('{')
    assert 'is damaged' in states()[0]['notes'][0]


def test_progress_of_a_lesson_notebook_is_refused_in_a_sentence(server):
    with server.progress('02_joint_state.ipynb') as response:
        assert 'is not the contents page' in json.load(response)['failed']


@pytest.mark.parametrize(
    ('path', 'token'), [('../index.ipynb', TOKEN), ('index.ipynb', 'another')]
)
def test_progress_outside_the_folder_or_with_a_wrong_token_is_forbidden(server, path, token):
    with pytest.raises(urllib.error.HTTPError) as refused:
        server.progress(path, token=token)
    assert refused.value.code == 403
