"""The language of lessons, of JupyterLab's menus, and of the terminals in it."""

import json
import locale
import shutil
from collections.abc import Mapping
from pathlib import Path

from launcher.environment import Environment
from launcher.messages import LauncherError
from launcher.words import put

ENGLISH = 'en'
OPTION, VARIABLE = '--language', 'COURSE_LANGUAGE'
"""The option that chooses a language, and the variable that passes it to child processes."""
PLAIN_LOCALE = 'C.UTF-8'
"""A locale that exists without being generated."""
INDEX = 'index.ipynb'
SETTINGS, OVERRIDES = '.jupyterlab', 'overrides.json'
"""JupyterLab's settings for lessons: they hide the instructors' panels."""
TRANSLATION = '@jupyterlab/translation-extension:plugin'


def choose_language(
    lessons: Path, variables: Mapping[str, str], arguments: list[str]
) -> tuple[str, list[str]]:
    """Return the language of the lessons, and the arguments without the option that chooses it.

    It is that of `--language zh_CN`, or else that of the JupyterLab whose terminal this is, or
    else that of the user's locale if there is such an edition. Raises LauncherError if there are
    no lessons in the language of `--language`.
    """
    known = [ENGLISH, *languages(lessons)]
    kept, asked = [], ''
    rest = iter(arguments)
    for argument in rest:
        name, found, value = argument.partition('=')
        if name != OPTION:
            kept.append(argument)
        else:
            asked = value if found else next(rest, '')
            if asked not in known:
                raise LauncherError(
                    "there are no lessons in '{asked}': --language takes {known}.",
                    asked=asked,
                    known=put(' or ').join(known),
                )
    chosen = variables.get(VARIABLE, '')
    return asked or (chosen if chosen in known else language_of_locale(lessons, variables)), kept


def languages(lessons: Path) -> list[str]:
    """Return the languages, other than English, in which there are lessons."""
    return sorted(page.parent.name for page in lessons.glob(f'*/{INDEX}'))


def language_of_locale(lessons: Path, variables: Mapping[str, str]) -> str:
    """Return the edition that fits the user's locale best: for zh_TW, it may be zh_CN."""
    known = [ENGLISH, *languages(lessons)]
    said = (variables.get(name) for name in ('LC_ALL', 'LC_MESSAGES', 'LANG'))
    theirs = next(filter(None, said), '').partition('.')[0].partition('@')[0]
    alike = [each for each in known if each.split('_')[0] == theirs.split('_')[0]]
    return theirs if theirs in known else next(iter(alike), ENGLISH)


def replaced_locale(variables: Mapping[str, str]) -> dict[str, str]:
    """Return a replacement for LC_ALL if this machine lacks that locale; else nothing.

    bash warns of a missing locale in every cell with a `!`. `VARIABLE` still has the language.
    """
    asked = variables.get('LC_ALL', '')
    return {'LC_ALL': PLAIN_LOCALE} if not _has_locale(asked) and _has_locale(PLAIN_LOCALE) else {}


def _has_locale(name: str) -> bool:
    before = locale.setlocale(locale.LC_ALL)
    try:
        locale.setlocale(locale.LC_ALL, name or before)
    except locale.Error:
        return False
    else:
        return True
    finally:
        locale.setlocale(locale.LC_ALL, before)


def jupyterlab_settings(environment: Environment, language: str) -> Path:
    """Return the folder of JupyterLab's settings, made in .venv if its menus are translated.

    For a language without an installed language pack, menus are in English. What a user chooses in
    JupyterLab overrides these settings.
    """
    ours = environment.root / SETTINGS
    if not has_menus(environment, language):
        return ours
    made = environment.venv / 'share/course' / f'jupyterlab-{language}'
    write_settings(environment, language, made)
    return made


def has_menus(environment: Environment, language: str) -> bool:
    """Whether a translation of JupyterLab's menus into a language is installed."""
    packs = f'lib/python*/site-packages/jupyterlab_language_pack_{language}'
    return language != ENGLISH and any(environment.venv.glob(packs))


def write_settings(environment: Environment, language: str, folder: Path) -> None:
    """Write JupyterLab's settings for lessons into a folder, with menus in a language."""
    shutil.copytree(environment.root / SETTINGS, folder, dirs_exist_ok=True)
    if has_menus(environment, language):
        settings = json.loads((folder / OVERRIDES).read_text(encoding='utf-8'))
        settings[TRANSLATION] = {'locale': language}
        (folder / OVERRIDES).write_text(json.dumps(settings, indent=2), encoding='utf-8')
