import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
from my_robot_basics.language.catalogues import read_translations

from grader.cli.arguments import make_parser
from grader.course import ROOT
from launcher import testing
from launcher.environment import Environment, without_foreign
from launcher.installer import DISK_IS_FULL, FAILED, NETWORK_IS_AWAY, progress, reason_of
from launcher.languages import TRANSLATION, jupyterlab_settings, replaced_locale
from launcher.main import run_verb
from launcher.messages import LauncherError
from launcher.set_up import BUILD_TOOLS, build_tools
from launcher.shares import executables_of
from launcher.testing import Checks
from launcher.unstable import (
    NO_KERNEL,
    add_unstable,
    count_causes,
    read_failures,
    read_passes,
    unstable,
)
from launcher.verbs import read_verbs
from launcher.words import put

# --- the table of the verbs ----------------------------------------------------------------------


def test_a_row_is_what_help_and_dispatch_are_made_from():
    verbs = read_verbs()
    grade = verbs['grade']
    assert (grade.owner, grade.runs, grade.folder) == ('course', 'grader grade', 'root')
    assert grade.help.startswith('grade what is new in gradebook/submitted/')
    assert [verb.name for verb in verbs.values() if verb.owner == 'everyone'] == [
        *('lab', 'validate', 'progress', 'workspace', 'ros-shell', 'wheels', 'hub')
    ]


def test_the_grader_has_the_verbs_that_the_table_says_it_has():
    (choices,) = (action.choices for action in make_parser()._actions if action.choices)
    said = [verb.runs for verb in read_verbs().values() if verb.runs.startswith('grader ')]
    assert sorted(said) == sorted(f'grader {name}' for name in choices)


@pytest.mark.parametrize(
    'row', ['nobody|launcher.lab|root|lab  open', 'everyone|launcher.lab|home|lab  open']
)
def test_a_wrong_row_is_refused(row, tmp_path):
    table = tmp_path / 'verbs.txt'
    table.write_text(f'# the verbs\n{row}\n')
    with pytest.raises(ValueError, match=re.escape(row)):
        read_verbs(table)


def test_a_new_verb_is_one_row(tmp_path):
    shutil.copy(ROOT / 'course', tmp_path)
    shutil.copytree(ROOT / 'launcher', tmp_path / 'launcher')
    with (tmp_path / 'launcher/verbs.txt').open('a') as table:
        table.write('everyone|launcher.wave|root|wave NAME          say hello\n')
    usage = subprocess.run([tmp_path / 'course', '--help'], capture_output=True, text=True)
    assert '  wave NAME          say hello\n' in usage.stdout
    assert read_verbs(tmp_path / 'launcher/verbs.txt')['wave'].help == 'say hello'


def test_it_needs_nothing_that_is_installed():
    code = (
        f'import sys; sys.path.append({str(ROOT)!r})\n'
        'from launcher import lab, main, testing\n'
        'names = {name.partition(".")[0] for name in sys.modules} - {"__main__", "launcher"}\n'
        'print(sorted(names - sys.stdlib_module_names))\n'
    )
    command = ['sh', '-c', 'exec "$@"', 'sh', sys._base_executable, '-ISc', code]
    run = subprocess.run(command, capture_output=True, text=True)
    assert (run.stdout, run.stderr) == ('[]\n', '')


# --- the user's language -------------------------------------------------------------------------

CATALOGUE = ROOT / 'locale/zh_CN/LC_MESSAGES/launcher.po'
NO_LOCALE = {'LC_ALL': '', 'LC_MESSAGES': '', 'LANG': '', 'COURSE_LANGUAGE': ''}
CHINESE_WORDS = {
    'of the locale': ([], {'LANG': 'zh_CN.UTF-8'}),
    'of another locale of the language': ([], {'LC_MESSAGES': 'zh_TW', 'LANG': 'de_DE'}),
    "of a lesson's terminal": ([], {'COURSE_LANGUAGE': 'zh_CN', 'LANG': 'en_GB'}),
    'asked for': (['--language', 'zh_CN'], {'LANG': 'en_GB'}),
    'of the locale, beside a language that there is not': (['--language=tlh'], {'LANG': 'zh_CN'}),
}
ENGLISH_WORDS = {
    'of another locale': ([], {'LANG': 'de_DE.UTF-8'}),
    'of no locale': ([], {'LANG': 'C.UTF-8'}),
    'of the stronger variable': ([], {'LC_ALL': 'C', 'LANG': 'zh_CN'}),
    'asked for': (['--language=en'], {'LANG': 'zh_CN'}),
    "of an English lesson's terminal": ([], {'COURSE_LANGUAGE': 'en', 'LANG': 'zh_CN'}),
    'where a path is the name': (['--language', '../zh_CN'], {}),
}


def said_by_course(*arguments, **variables):
    environment = os.environ | NO_LOCALE | variables
    command = [ROOT / 'course', *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize(('asked', 'locale'), CHINESE_WORDS.values(), ids=CHINESE_WORDS)
def test_course_speaks_the_language(asked, locale):
    run = said_by_course('tidy', *asked, **locale)
    assert run.stderr == 'course: 没有“tidy”这个命令：./course --help 会列出所有命令。\n'


@pytest.mark.parametrize(('asked', 'locale'), ENGLISH_WORDS.values(), ids=ENGLISH_WORDS)
def test_course_speaks_english(asked, locale):
    run = said_by_course('tidy', *asked, **locale)
    assert run.stderr == "course: there is no verb 'tidy': ./course --help lists them.\n"


def test_the_help_is_the_same_table_in_each_language():
    english = said_by_course('--help').stdout.splitlines()
    chinese = said_by_course('--help', '--language', 'zh_CN').stdout.splitlines()
    assert english[0] == 'usage: ./course VERB [ARGUMENT...]'
    assert chinese[0] == '用法：./course VERB [ARGUMENT...]'
    assert len(chinese) == len(english)
    for ours, theirs in zip(english[1:], chinese[1:], strict=True):
        usage = re.match(r' *(.*?)  +', ours)
        at = usage.end() if usage else 0
        assert theirs[:at] == ours[:at]
        assert re.search('[\u3400-\u9fff]', theirs) or not ours


def test_the_launcher_reads_catalogues_as_others_do(monkeypatch):
    monkeypatch.setenv('COURSE_WORDS', str(CATALOGUE))
    known = read_translations(ROOT / 'locale', 'zh_CN', 'launcher')
    assert len(known) > 40
    assert {english: put(english) for english in known} == known
    failed = LauncherError(
        'the folder {root} is read-only: copy the course into a folder of your '
        'own and start it there.',
        root='/a {b}',
    )
    assert str(failed).startswith('文件夹 /a {b} 是只读的：')
    assert reason_of(['No space left on device']) == DISK_IS_FULL
    assert str(LauncherError(DISK_IS_FULL)).startswith('磁盘已满：')


SPEAKS = {'say', 'put', 'marked', 'LauncherError'}
SPEAKING = sorted({*(ROOT / 'launcher').glob('*.py')} - {ROOT / 'launcher/testing.py'})
"""`./course test` speaks to developers, in English."""


@pytest.mark.parametrize('path', SPEAKING, ids=lambda path: path.name)
def test_every_sentence_of_the_launcher_can_be_translated(path):
    calls = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]
    assert not [
        call.lineno
        for call in calls
        if getattr(call.func, 'id', '') in SPEAKS
        and call.args
        and isinstance(
            call.args[0], ast.JoinedStr
        )  # translate finds no text that has values in it
    ]


def test_what_somebody_has_to_look_at_stays_english(tmp_path, monkeypatch):
    catalogue = tmp_path / 'launcher.po'
    entries = [
        '#, fuzzy\nmsgid "a \\"b\\""\nmsgstr "甲"\n',
        'msgid ""\n"one "\n"two"\nmsgstr "乙"\n',
    ]
    catalogue.write_text('\n'.join(entries), encoding='utf-8')
    monkeypatch.setenv('COURSE_WORDS', str(catalogue))
    assert [put('a "b"'), put('one two'), put('else')] == ['a "b"', '乙', 'else']
    monkeypatch.setenv('COURSE_WORDS', str(tmp_path / 'none.po'))
    assert put('one two') == 'one two'


@pytest.mark.parametrize(('verb', 'language'), [('workspace', 'zh_CN'), ('grade', None)])
def test_what_grades_does_not_speak_the_language_of_the_terminal(verb, language, monkeypatch):
    monkeypatch.setenv('COURSE_LANGUAGE', 'zh_CN')
    monkeypatch.chdir(ROOT)
    started = []
    monkeypatch.setattr(os, 'execve', lambda *command: started.append(command))
    run_verb(Environment(ROOT), read_verbs()[verb], [])
    ((_, _, variables),) = started
    assert variables.get('COURSE_LANGUAGE') == language


# --- variables -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('folders', 'kept'),
    [
        ('/usr/bin:/opt/ros/jazzy/bin:/opt/rosy', '/usr/bin:/opt/rosy'),
        ('/opt/ros', ''),
        ('', ''),
        ('::/usr/bin:', '/usr/bin'),
        ('/home/ada/ros ws/bin/', ''),
    ],
)
def test_folders_of_other_environments_are_left_out(folders, kept):
    assert without_foreign(folders, {'/opt/ros', '/home/ada/ros ws'}) == kept


def test_what_the_caller_asked_of_his_workspace_stays():
    environment = Environment(Path('/course'))
    inside = environment.variables({'PATH': '/bin', 'MY_ROBOT_BASICS_WORKSPACE': '/mine'})
    assert inside['ROS_WS'] == '/mine'
    assert inside['PATH'] == '/course/.venv/bin:/bin'
    assert 'COLCON_PYTHON_EXECUTABLE' not in inside


# --- installers ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('line', 'step'),
    [
        ('Collecting six==1.17.0 (from -r environment.txt (line 7))', 'Collecting six==1.17.0'),
        ('Installing collected packages: six, pip', 'Installing'),
        ('Using CPython 3.12.1', ''),
    ],
)
def test_the_steps_of_an_installer_are_shown(line, step):
    assert progress(line) == step


def test_a_full_disk_is_the_reason_whatever_else_went_wrong():
    assert reason_of(['Max retries exceeded', 'No space left on device']) == DISK_IS_FULL
    assert reason_of(['x', 'error: Failed to fetch: `https://…`']) == NETWORK_IS_AWAY


def test_only_the_last_words_of_an_unknown_reason_are_shown():
    lines = [f'line {number}' for number in range(30)]
    assert reason_of(lines).split('\n') == [*lines[10:], FAILED]


def test_the_executables_are_those_of_setup_py():
    setup = "    'a_node = my_robot_basics.a_node:main',\n    'other = elsewhere.other:main',\n"
    assert executables_of(setup) == ['a_node']


# --- tests that fail beside others and pass alone ------------------------------------------------


def report(path, **cases):
    """Write what pytest writes: each case failed with these words, or passed."""
    bodies = {
        name: f'<failure message={quoteattr(why)}/>' if why else '' for name, why in cases.items()
    }
    rows = [f'<testcase classname="f" name="{n}">{body}</testcase>' for n, body in bodies.items()]
    path.write_text(f'<testsuites><testsuite>{"".join(rows)}</testsuite></testsuites>')
    return path


def test_what_failed_and_then_passed_is_unstable(tmp_path):
    failures = read_failures(report(tmp_path / '1', a='late\nby 2 s', b='wrong', c='late', d=''))
    assert failures == {'f::a': 'late by 2 s', 'f::b': 'wrong', 'f::c': 'late'}
    passes = read_passes(report(tmp_path / '2', a='', b='wrong'))
    assert unstable(failures, passes) == {'f::a': 'late by 2 s'}


def test_no_report_is_no_test(tmp_path):
    assert read_failures(tmp_path / 'none') == {}
    assert read_passes(tmp_path / 'none') == set()


def test_the_record_counts_those_of_all_runs(tmp_path):
    record = tmp_path / 'unstable_tests.txt'
    assert add_unstable(record, {'f::a': 'late'}) == 1
    assert add_unstable(record, {'f::a': 'late', 'f::b': 'late'}) == 3
    assert record.read_text().splitlines()[0].endswith('  f::a: late')


def test_all_cells_of_a_lesson_whose_kernel_did_not_start_have_one_cause():
    why = f'{NO_KERNEL} replying to kernel_info"'
    lesson = {f'solutions.08.ipynb::Cell {number}': why for number in range(26)}
    assert count_causes(lesson) == 1
    assert count_causes(lesson | {'solutions.09.ipynb::Cell 0': why}) == 2
    late = {f'solutions.10.ipynb::Cell {number}': 'late' for number in range(3)}
    assert count_causes(lesson | late) == 4
    assert count_causes({}) == 0


@pytest.mark.parametrize(
    ('number', 'why', 'status'),
    [(0, '', 0), (1, 'late', 0), (2, 'late', 0), (3, 'late', 1), (26, f'{NO_KERNEL} …"', 0)],
    ids=['none', 'one', 'two', 'three', 'no kernel'],
)
def test_more_than_two_unstable_tests_fail_a_run(number, why, status, tmp_path, capsys):
    names = [f't{each}' for each in range(number)]
    checks = Checks(Environment(tmp_path), {}, tmp_path)

    report(tmp_path / 'tests.xml', good='', **dict.fromkeys(names, why))

    def pass_alone():
        report(tmp_path / 'tests-alone.xml', **dict.fromkeys(names, ''))
        return ['true']

    assert checks.again('tests', 1, pass_alone) == status
    record = tmp_path / 'unstable_tests.txt'
    assert record.exists() == bool(number)
    if number:
        assert len(record.read_text().splitlines()) == number
        assert 'failed beside others and passed alone' in capsys.readouterr().err


@pytest.mark.starts
@pytest.mark.parametrize(
    ('source', 'why'),
    [
        ('import nothing_like_this', "ModuleNotFoundError: No module named 'nothing_like_this'"),
        ('from os import nothing', "ImportError: cannot import name 'nothing' from 'os'"),
        ('def test_a(:', 'SyntaxError: invalid syntax'),
        ('1 / 0', 'ZeroDivisionError: division by zero'),
    ],
)
def test_a_file_that_cannot_be_imported_is_named_and_not_run_again(source, why, tmp_path, capsys):
    (tmp_path / 'test_broken.py').write_text(source)
    (tmp_path / 'test_good.py').write_text('def test_good(): pass')
    checks = Checks(Environment(tmp_path), {}, tmp_path)

    written = f'--junitxml={tmp_path / "tests.xml"}'
    command = [sys.executable, '-m', 'pytest', '-q', '-n', '1', written]
    status = subprocess.run(command, cwd=tmp_path, stdout=subprocess.DEVNULL).returncode
    alone = pytest.fail  # what cannot be imported is not run once more
    assert checks.again('tests', status, alone) == 1
    said = capsys.readouterr().err
    assert said.startswith('course: test_broken.py could not be imported, so none of its tests')
    assert f' were run: {why}' in said
    assert said.endswith('course: fix that, and run this again\n')
    assert 'beside others' not in said


def test_every_package_without_a_wheel_is_built_with_tools_that_are_pinned():
    """pip's own environments for builds take no hashes: on an empty cache, it failed."""
    pins = build_tools(ROOT / 'environment.txt')
    assert [line.split('==')[0] for line in pins.splitlines()[::2]] == list(BUILD_TOOLS)
    assert pins.count('--hash=sha256:') >= len(BUILD_TOOLS)


@pytest.mark.starts
def test_a_mistake_in_an_argument_of_pytest_ends_all_of_it_at_once(tmp_path, monkeypatch):
    types = f'sleep 10; touch {tmp_path}/waited-for'
    for name, does in {'ruff': 'exit 0', 'mypy': types, 'python': 'exit 4'}.items():
        program = tmp_path / '.venv/bin' / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text(f'#!/bin/sh\n{does}\n')
        program.chmod(0o755)
    assert testing.run(Environment(tmp_path), {'PATH': os.environ['PATH']}, ['--bogus']) == 4
    assert not (tmp_path / 'waited-for').exists()


@pytest.mark.starts
def test_who_asks_for_help_gets_that_of_pytest_alone(tmp_path, capfd):
    python = tmp_path / '.venv/bin/python'
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$@"\n')
    python.chmod(0o755)  # there is no ruff, and none is called
    assert testing.run(Environment(tmp_path), {'PATH': os.environ['PATH']}, ['--help']) == 0
    assert capfd.readouterr().out == '-P -m pytest --help\n'


@pytest.mark.starts
@pytest.mark.parametrize(
    ('command', 'has_one'), [(('env',), True), (('false',), False), (('no-such-program',), False)]
)
def test_without_a_network_of_their_own_the_lessons_come_after_the_tests(
    monkeypatch, command, has_one
):
    monkeypatch.setattr(testing, 'OWN_NETWORK', command)
    assert testing.has_own_network() == has_one


@pytest.mark.starts
@pytest.mark.isolation
def test_the_lessons_are_in_a_network_of_their_own():
    seen = subprocess.run(
        [*testing.OWN_NETWORK, 'sh', '-c', 'readlink /proc/self/ns/net; ls -A /dev/shm'],
        capture_output=True,
        text=True,
        check=True,
    )
    assert seen.stdout.strip() != os.readlink('/proc/self/ns/net')
    assert seen.stdout.count('\n') == 1  # shared memory of others is not there


def test_the_tests_of_a_fresh_clone_are_compiled_once(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(testing.subprocess, 'run', lambda command, **_: calls.append(command))
    checks = Checks(Environment(tmp_path), {}, tmp_path)
    checks.compile_tests()
    compiled = tmp_path / 'tests/__pycache__/test_a.cpython-311-pytest-9.2.0.pyc'
    compiled.parent.mkdir(parents=True)
    compiled.touch()
    checks.compile_tests()
    assert ['--collect-only' in command for command in calls] == [True]


# --- languages -----------------------------------------------------------------------------------


@pytest.fixture
def with_pack(tmp_path):
    """A course whose .venv has JupyterLab's language pack for zh_CN."""
    shutil.copytree(ROOT / '.jupyterlab', tmp_path / '.jupyterlab')
    (tmp_path / '.venv/lib/python3.12/site-packages/jupyterlab_language_pack_zh_CN').mkdir(
        parents=True
    )
    return Environment(tmp_path)


def test_jupyterlab_has_menus_in_the_language_of_the_lessons(with_pack):
    for _ in range(2):  # made anew, as after an update of the course
        folder = jupyterlab_settings(with_pack, 'zh_CN')
    settings = json.loads((folder / 'overrides.json').read_text())
    ours = json.loads((ROOT / '.jupyterlab/overrides.json').read_text())
    assert settings == ours | {TRANSLATION: {'locale': 'zh_CN'}}
    pages = [each / 'page_config.json' for each in (folder, ROOT / '.jupyterlab')]
    assert pages[0].read_bytes() == pages[1].read_bytes()


@pytest.mark.parametrize('language', ['en', 'de'])
def test_without_a_language_pack_menus_are_english(with_pack, language):
    assert jupyterlab_settings(with_pack, language) == with_pack.root / '.jupyterlab'


def test_each_language_of_the_course_has_a_language_pack():
    for folder in (ROOT / 'notebooks').glob('*/index.ipynb'):
        language = folder.parent.name
        assert jupyterlab_settings(Environment(ROOT), language) != ROOT / '.jupyterlab'
        from jupyterlab_server.translation_utils import get_language_packs

        assert language in get_language_packs()[0]


@pytest.mark.parametrize(
    ('asked', 'found'),
    [({'LC_ALL': 'zh_XX.UTF-8'}, 'C.UTF-8'), ({'LC_ALL': 'C'}, 'C'), ({'LANG': 'zh_XX'}, None)],
    ids=['not generated', 'there', 'of a variable that bash does not warn of'],
)
def test_bash_does_not_warn_of_a_locale_that_is_not_generated(asked, found):
    variables = asked | replaced_locale(asked)
    assert variables.get('LC_ALL') == found
    run = subprocess.run(['bash', '-c', ':'], env=variables, capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, '')


def test_lessons_stay_chinese_in_a_chinese_locale_that_is_not_generated(monkeypatch):
    monkeypatch.setenv('LC_ALL', 'zh_XX.UTF-8')
    monkeypatch.delenv('COURSE_LANGUAGE', raising=False)
    called = {}
    monkeypatch.setattr(os, 'chdir', lambda folder: None)
    monkeypatch.setattr(os, 'execve', lambda *call: called.update(call[-1]))
    run_verb(Environment(ROOT), read_verbs()['workspace'], [])
    assert called['LC_ALL'] == 'C.UTF-8'
    assert called['COURSE_LANGUAGE'] == 'zh_CN'
