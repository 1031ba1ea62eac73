"""The catalogues follow the English texts, and a translation keeps what has to be kept."""

import re
import shutil

import pytest
from course_maker import TOY, make_course, toy_lesson, write_source
from my_robot_basics.language.catalogues import catalogue_path, languages, read_translations
from my_robot_basics.language.speaking import PARTS
from translation_faults import faults_of, read_glossary, unknown_terms

from grader.authoring.blocks import (
    split_blocks,
    translatable_blocks,
    translatable_html,
    translate_blocks,
    translate_html,
)
from grader.authoring.editions import editions, is_translated
from grader.authoring.translatable import MODULES, parts_of
from grader.authoring.translate import report_lines, update_catalogues
from grader.common.errors import CourseError
from grader.course import ROOT, Course

# --- blocks --------------------------------------------------------------------------------------


def texts(course):
    """Yield all texts of the course that are translated."""
    for name in course.assignments():
        for cell in course.source(name).cells:
            if is_translated(cell):
                yield cell.source
    for page in ('terms.md', 'what_next.md', 'students.md'):
        yield (course.root / 'solutions' / page).read_text(encoding='utf-8')


def test_blocks_and_the_gaps_between_them_add_up_to_the_text():
    whole = list(texts(Course()))
    assert len(whole) > 100
    for text in whole:
        pieces = split_blocks(text)
        assert ''.join(pieces) == text
        assert not ''.join(pieces[::2]).strip()
        assert all(block.strip() and not block.endswith('\n') for block in pieces[1::2])


def test_a_block_ends_at_a_blank_line_and_each_table_row_is_a_block():
    text = 'One\ntwo.\n\n| a | b |\n|---|---|\n| `c` | 3 |\nnext\n\n```\nx\n\ny\n```\nend\n'
    assert split_blocks(text)[1::2] == [
        *('One\ntwo.', '| a | b |', '|---|---|', '| `c` | 3 |', 'next', '```\nx\n\ny\n```\nend'),
    ]
    assert translatable_blocks(
        '| a | be |\n|---|---|\n| `c` | 3 |\n\n`code`\n\n$alpha$\n\n## Exercise: `a`'
    ) == [
        '| a | be |',
        '## Exercise: `a`',
    ]


def test_a_block_without_a_translation_stays_english():
    assert translate_blocks('One.\n\nTwo.\n', {'Two.': '二。'}) == 'One.\n\n二。\n'


PAGE = """\
<html lang="en">
<title>Nothing arrives?</title>
<tr><th class="a">command</th><td><code>list</code></td>
<td>Ask <code>who</code> <i>it</i> is.</td></tr>
"""


def test_the_elements_of_a_page_are_translated_one_by_one():
    texts = ['Nothing arrives?', 'command', 'Ask <code>who</code> <i>it</i> is.']
    assert translatable_html(PAGE) == texts
    chinese = {'command': '命令', texts[2]: '问它是<i>谁</i>。'}
    assert translate_html(PAGE, chinese, 'zh_CN') == (
        PAGE.replace('"en"', '"zh-CN"')
        .replace('>command<', '>命令<')
        .replace(texts[2], chinese[texts[2]])
    )


# --- catalogues ----------------------------------------------------------------------------------

OPENING = """\
# A toy

You double numbers. There are two ways.

| check | points |
|---|---|
| `double` | 3 |

Add a number to itself, or multiply it by 2.
"""
CHINESE = {
    '# A toy': '# 玩具',
    'You double numbers. There are two ways.': '把数翻倍。有两种办法。',
    '| check | points |': '| 检查 | 分 |',
    'Add a number to itself, or multiply it by 2.': '把数与自己相加，或者乘以 2。',
}


@pytest.fixture
def course(tmp_path):
    """A small course of which every block is translated."""
    course = make_course(tmp_path)
    write_opening(course, OPENING)
    (course.root / 'locale/zh_CN/LC_MESSAGES').mkdir(parents=True)
    update_catalogues(course)
    translate(course, CHINESE)
    update_catalogues(course)
    return course


def write_opening(course, text):
    lesson = toy_lesson()
    lesson.cells[0].source = text
    write_source(course, lesson)


def translate(course, translations):
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    text = path.read_text(encoding='utf-8')
    for english, chinese in translations.items():
        text = text.replace(
            f'msgid "{english}"\nmsgstr ""', f'msgid "{english}"\nmsgstr "{chinese}"'
        )
    path.write_text(text, encoding='utf-8')


def of_the_toy(reports):
    (report,) = (each for each in reports if each.part == TOY)
    return report


def test_translations_in_a_catalogue_are_read_back(course):
    locale = course.root / 'locale'
    assert languages(locale) == ['zh_CN']
    assert read_translations(locale, 'zh_CN', TOY) == CHINESE
    assert read_translations(locale, 'zh_CN', 'no such part') == {}
    report = of_the_toy(update_catalogues(course))
    assert (report.texts, report.missing, report.outdated) == (4, (), ())


def test_an_update_without_a_change_changes_no_file(course):
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    before = path.read_bytes()
    update_catalogues(course)
    assert path.read_bytes() == before
    assert b'Date' not in before


def test_a_second_update_of_a_new_catalogue_changes_nothing(course):
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    path.unlink()
    update_catalogues(course)
    before = path.read_bytes()
    assert before.startswith(b'msgid ""')
    update_catalogues(course)
    assert path.read_bytes() == before


def test_the_edit_of_one_sentence_puts_one_block_out_of_date(course):
    write_opening(course, OPENING.replace('two ways', 'three ways'))
    report = of_the_toy(update_catalogues(course))
    assert report.outdated == (('title', 'You double numbers. There are three ways.'),)
    assert report.missing == ()
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    text = path.read_text(encoding='utf-8')
    assert '#| msgid "You double numbers. There are two ways."' in text
    assert '把数翻倍' in text
    (edition,) = editions(course)
    assert edition.text(TOY, 'You double numbers. There are three ways.').startswith('You double')
    said = '\n'.join(report_lines([report]))
    assert f'zh_CN  {TOY}: 3 of 4' in said
    assert 'out of date: title: You double numbers. There are three ways.' in said


def test_a_part_that_is_not_begun_is_named_with_its_file(course):
    catalogue_path(course.root / 'locale', 'zh_CN', TOY).unlink()
    assert [*report_lines([of_the_toy(update_catalogues(course))])] == [
        f'zh_CN  {TOY}: 0 of 4',
        f'    not begun: fill the msgstr lines of locale/zh_CN/LC_MESSAGES/{TOY}.po',
    ]


def test_the_former_english_text_is_removed_with_the_mark_fuzzy(course):
    write_opening(course, OPENING.replace('two ways', 'three ways'))
    update_catalogues(course)
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    text = path.read_text(encoding='utf-8')
    path.write_text(text.replace('#, fuzzy\n', ''), encoding='utf-8')
    assert of_the_toy(update_catalogues(course)).outdated == ()
    assert 'two ways' in text
    assert 'two ways' not in path.read_text(encoding='utf-8')


def test_only_the_edited_block_is_english_before_the_catalogue_is_updated(course):
    (edition,) = editions(course)
    edited = OPENING.replace('two ways', 'three ways')
    before, after = edition.text(TOY, OPENING), edition.text(TOY, edited)
    changed = [
        (one, other)
        for one, other in zip(before.splitlines(), after.splitlines(), strict=True)
        if one != other
    ]
    assert changed == [
        (CHINESE['You double numbers. There are two ways.'], edited.splitlines()[2])
    ]


def test_a_deleted_block_is_removed_from_the_catalogue(course):
    write_opening(course, OPENING.replace('You double numbers. There are two ways.\n\n', ''))
    assert of_the_toy(update_catalogues(course)).texts == 3
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    assert '翻倍' not in path.read_text(encoding='utf-8')


def test_a_damaged_catalogue_is_named(course):
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    path.write_text('msgid "A"\nmsgstr "B\nno quotes\n', encoding='utf-8')
    with pytest.raises(CourseError, match=rf'{TOY}\.po cannot be read: '):
        update_catalogues(course)
    (edition,) = editions(course)
    with pytest.raises(CourseError, match=rf'{TOY}\.po cannot be read: '):
        edition.translations(TOY)


def test_each_catalogue_that_belongs_to_no_lesson_is_named(course):
    for gone in ('gone', 'lost'):
        catalogue_path(course.root / 'locale', 'zh_CN', gone).write_text('', encoding='utf-8')
    with pytest.raises(
        CourseError, match=r'gone\.po belongs to no lesson.*lost\.po belongs to no'
    ):
        update_catalogues(course)


def test_sentences_for_one_and_for_many_do_not_differ_by_an_inserted_verb():
    """Chinese has one word for both: an entry for each verb would be listed as missing."""
    parts = parts_of(Course())
    texts = {text for part in MODULES for text in parts[part]}
    forms = ('is are', 'was were', 'has have', 'does do', 'fails fail', 'its their', 'it them')
    assert [pair for pair in forms if set(pair.split()) <= texts] == []


def test_texts_that_only_instructors_read_are_not_translated():
    parts = parts_of(Course())
    everything = '\n'.join(text for part in parts.values() for text in part)
    assert 'MARK SCHEME' not in everything
    assert 'Half a point for each' not in everything


def test_the_texts_are_the_same_whatever_the_name_of_the_checkouts_folder(tmp_path):
    checkout = tmp_path / 'live'
    checkout.symlink_to(Course().root)
    assert parts_of(Course(root=checkout))['checks'] == parts_of(Course())['checks']


# --- what a translation keeps --------------------------------------------------------------------

FAULTS = {
    'a code span': ('Call `run()` twice.', '把 `Run()` 调用两次。', 'code'),
    'a number': ('It takes 20 s.', '需要 2 s。', 'numbers: 20 lost'),
    'a link': ('See [terms](../terms.md).', '见[术语](terms.md)。', 'where a link leads'),
    'a column': ('| one | two |', '| 一 |', 'columns'),
    'an item': ('- one\n- two', '- 一、二', 'items'),
    'a heading': ('## The arm', '# 机械臂', 'heading'),
    'a formula': ('So $a + b$ counts.', '$a - b$ 才算。', 'formula'),
    'a placeholder': ('{name} is late', '{who} 来晚了', 'places: {name}, {who}'),
    'fenced code': ('```\nls\n```', '```\nll\n```', 'fenced code'),
    'a tag': ('a <i>topic</i>', '话题', 'a tag'),
    'bold type': ('a **node** and', '节点和', 'bold type'),
    'bold type that shows': ('**Predict:** when?', '**预测：**何时？', 'not shown in bold'),
    'italic type that shows': ('*No error.* Try', '*没有错误。*试试', 'not shown in italic'),
    'a bold link': ('a **[node](t.md)** is', '**[节点](t.md)**是', 'not shown in bold'),
    'spaces': ('the node `a` is', '节点`a`是', 'no space between'),
    'marks': ('A node, a topic', '节点, 话题', 'a Latin mark'),
    'spaces at marks': ('A node, a topic', '节点， 话题', 'a space beside'),
}


@pytest.mark.parametrize(('english', 'chinese', 'said'), FAULTS.values(), ids=FAULTS)
def test_each_fault_of_a_translation_is_found(english, chinese, said):
    assert re.search(said, '\n'.join(faults_of(english, chinese)))


GOOD = {
    'Call `run()` **twice** in 2.5 s.': '在 2.5 s 内**两次**调用 `run()`。',
    '| **all** | [one](a.md) |': '| **全部** | [一](a.md) |',
    'A **[node](t.md)** is here (really).': '[**节点**](t.md)就在这里（真的）。',
    '**Predict:** what?\n- a\n- b': '**预测**：是什么？\n- 甲\n- 乙',
    '3D at https://a.org': '三维，见 https://a.org',
}


@pytest.mark.parametrize(('english', 'chinese'), GOOD.items())
def test_a_good_translation_has_no_fault(english, chinese):
    assert list(faults_of(english, chinese)) == []


def test_a_term_translated_against_the_glossary_is_found():
    glossary = {'topic': ['话题'], 'end effector': ['末端执行器', '末端']}
    assert list(unknown_terms('Two topics.', '两个主题。', glossary)) == ['topic: expected 话题']
    assert list(unknown_terms('The `topic`; an end effector.', '末端。', glossary)) == []
    assert list(unknown_terms('What *Topic name* is', '*Topic name* 是什么', glossary)) == []


# --- the course's own translations ---------------------------------------------------------------

TRANSLATED = [
    (file.parts[-3], file.stem) for file in sorted((ROOT / 'locale').glob('*/LC_MESSAGES/*.po'))
]


WHOLE = ('zh_CN',)
"""Editions that must be complete; one that was just begun need not be."""


@pytest.fixture(scope='module')
def updated(tmp_path_factory):
    """A copy of the course, and what `./course translate` reports there."""
    root = tmp_path_factory.mktemp('translated')
    for each in ROOT.iterdir():
        if each.name not in ('locale', 'gradebook'):
            (root / each.name).symlink_to(each)
    shutil.copytree(ROOT / 'locale', root / 'locale')
    return root, update_catalogues(Course.at(root))


@pytest.mark.timeout(120)
def test_the_catalogues_are_up_to_date_with_the_english_texts(updated):
    """After each edit of an English text, `./course translate` has to be run."""
    root, _ = updated
    made = {path.relative_to(root) for path in root.glob('locale/**/*.po')}
    kept = {path.relative_to(ROOT) for path in ROOT.glob('locale/**/*.po')}
    differ = (made ^ kept) | {
        path for path in made & kept if (root / path).read_bytes() != (ROOT / path).read_bytes()
    }
    assert sorted(map(str, differ)) == [], 'run ./course translate, and look at what has changed'


@pytest.mark.timeout(120)
def test_a_complete_edition_has_no_missing_or_outdated_translation(updated):
    """A new lesson whose catalogue nobody has filled is released in English, without an error."""
    reports = [each for each in updated[1] if each.language in WHOLE]
    assert {each.language for each in reports} == {*WHOLE}
    left = {
        (each.language, each.part): len(each.missing + each.outdated)
        for each in reports
        if each.missing or each.outdated
    }
    assert left == {}, '`./course translate` lists what to translate'


@pytest.mark.parametrize('language', WHOLE)
def test_each_lesson_has_its_notebook_in_a_complete_edition(language):
    names = Course().assignments()
    assert len(names) > 10
    released = ROOT / 'notebooks' / language
    assert [name for name in names if not (released / name / f'{name}.ipynb').is_file()] == []


@pytest.mark.parametrize(('language', 'part'), TRANSLATED)
def test_translations_of_the_course_have_no_faults(language, part):
    assert {
        english: faults
        for english, text in read_translations(ROOT / 'locale', language, part).items()
        if (faults := list(faults_of(english, text)))
    } == {}


@pytest.mark.parametrize(('language', 'part'), TRANSLATED)
def test_no_two_placeholders_of_a_sentence_are_adjacent(language, part):
    """It would be unclear where the first text ends: write a whole sentence for each case."""
    if part in PARTS:
        known = read_translations(ROOT / 'locale', language, part)
        assert [english for english in known if '}{' in english] == []


@pytest.mark.parametrize(('language', 'part'), TRANSLATED)
def test_translations_use_the_terms_of_the_glossary(language, part):
    glossary = read_glossary(ROOT / 'locale' / language / 'glossary.txt')
    assert {
        english: unknown
        for english, text in read_translations(ROOT / 'locale', language, part).items()
        if (unknown := list(unknown_terms(english, text, glossary)))
    } == {}
