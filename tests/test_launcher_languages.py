"""The language that `./course` speaks, and that of the lessons and of JupyterLab."""

import ast
import json
import os
import re
import shutil
import subprocess

import pytest
from my_robot_basics.language.catalogues import read_translations

from grader.course import ROOT
from launcher.environment import Environment
from launcher.installer import DISK_IS_FULL, reason_of
from launcher.languages import TRANSLATION, jupyterlab_settings, replaced_locale
from launcher.main import run_verb
from launcher.messages import LauncherError
from launcher.verbs import read_verbs
from launcher.words import put

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
def test_course_speaks_chinese_if_chosen_by_locale_terminal_or_option(asked, locale):
    run = said_by_course('tidy', *asked, **locale)
    assert run.stderr == 'course: 没有“tidy”这个命令：./course --help 会列出所有命令。\n'


@pytest.mark.parametrize(('asked', 'locale'), ENGLISH_WORDS.values(), ids=ENGLISH_WORDS)
def test_course_speaks_english_unless_chinese_is_chosen(asked, locale):
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


def test_the_launcher_reads_catalogues_as_the_students_package_does(monkeypatch):
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


SPEAKS = {'say', 'put', 'gettext_noop', 'LauncherError'}
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


def test_fuzzy_translations_of_the_launcher_are_not_used(tmp_path, monkeypatch):
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
def test_verbs_that_grade_ignore_the_language_of_the_terminal(verb, language, monkeypatch):
    monkeypatch.setenv('COURSE_LANGUAGE', 'zh_CN')
    monkeypatch.chdir(ROOT)
    started = []
    monkeypatch.setattr(os, 'execve', lambda *command: started.append(command))
    run_verb(Environment(ROOT), read_verbs()[verb], [])
    ((_, _, variables),) = started
    assert variables.get('COURSE_LANGUAGE') == language


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
def test_menus_are_english_without_a_language_pack(with_pack, language):
    assert jupyterlab_settings(with_pack, language) == with_pack.root / '.jupyterlab'


def test_each_language_of_the_course_has_a_language_pack():
    languages = [path.parent.name for path in (ROOT / 'notebooks').glob('*/index.ipynb')]
    assert 'zh_CN' in languages
    for language in languages:
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
