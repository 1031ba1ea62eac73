"""The synthetic class: of any size, always the same, and with known scores."""

import ast
from collections import Counter
from dataclasses import replace

import nbformat
import pytest
from course_maker import executed
from sample_class import EXPECTED, PATHS, assignment_of
from stand_in import stand_in
from synthetic_class import hand_in, synthetic_class, wrong_scores, zip_up

from grader.collect.collect import NEW, collect
from grader.course import Course
from grader.grade import grade_all
from grader.judging.execute import Execution
from grader.notebook.restore import restore, role
from grader.storage import reuse
from grader.storage.submitted import find_submissions


@pytest.fixture(scope='module')
def papers():
    return synthetic_class(80)


@pytest.mark.slow
def test_the_same_arguments_give_the_same_class(papers):
    assert synthetic_class(80) == papers
    assert synthetic_class(20, seed=1) != papers[:20]


def test_every_student_has_a_paper_and_no_two_are_alike(papers):
    assert len({paper.student_id for paper in papers}) == 80
    alike = Counter(p.text for p in papers if '-not_json' not in p.sample)
    assert alike.most_common(1)[0][1] == 1


def test_assignments_come_in_turn_and_most_answers_are_right(papers):
    counts = Counter(paper.assignment for paper in papers)
    assert set(counts) == set(Course().assignments())
    assert max(counts.values()) - min(counts.values()) <= 1
    assert 40 < sum('-pass-' in paper.sample for paper in papers) < 60


def test_every_sample_is_used_once_before_one_is_repeated():
    samples = {name for name in PATHS if assignment_of(PATHS[name]) == '06_qos'}
    came = [paper.sample for paper in synthetic_class(8 * len(samples), assignments=['06_qos'])]
    for pile in ({s for s in samples if '-pass-' in s}, {s for s in samples if '-pass-' not in s}):
        first = [sample for sample in came if sample in pile][: len(pile)]
        assert sorted(first) == sorted(pile)


def test_a_class_can_be_made_of_chosen_samples():
    chosen = ('02_joint_state-pass-numpy', '03_publisher-fail-1hz')
    assert {paper.sample for paper in synthetic_class(9, samples=chosen)} == set(chosen)


@pytest.mark.parametrize('name', PATHS)
def test_variations_of_a_sample_change_nothing_that_is_graded(name):
    """All that is graded is as in the sample; only remarks and prints of texts are added."""
    [paper] = synthetic_class(1, samples=[name])
    if name == '03_publisher-zero-not_json':
        assert paper.text == PATHS[name].read_text(encoding='utf-8')
        return
    template = Course().template(paper.assignment)
    sample = restore(nbformat.read(PATHS[name], as_version=4), template)
    varied = restore(nbformat.reads(paper.text, as_version=4), template)
    assert varied.notes == sample.notes
    graded, in_sample = (
        [c for c in restored.notebook.cells if role(c) in ('setup', 'locked', 'answer', 'grade')]
        for restored in (varied, sample)
    )
    assert len(graded) == len(in_sample)
    for cell, kept in zip(graded, in_sample, strict=True):
        if role(cell) == 'answer' and cell.source != kept.source:
            # an answer in two parts has something behind each
            for part in kept.source.split('\n\nclass '):
                assert part.rstrip() in cell.source
            added = cell.source.removeprefix(kept.source.rstrip())
            assert '-split_answer' in name or only_prints(added)
        else:
            assert cell.source == kept.source
    known = {cell.source for cell in sample.notebook.cells}
    own = [c for c in varied.notebook.cells if role(c) == 'free' and c.source not in known]
    assert len(own) == 1
    assert only_prints(own[0].source)


def only_prints(source):
    return all(
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Call)
        and node.value.func.id == 'print'
        and all(isinstance(argument, ast.Constant) for argument in node.value.args)
        for node in ast.parse(source).body
    )


def test_every_paper_is_collected_from_the_archive(papers, tmp_path):
    zip_up(papers, tmp_path / 'class.zip')
    course = Course(gradebook=tmp_path / 'gradebook')
    rows = list(collect(course, tmp_path / 'class.zip'))
    assert [(row.student_id, row.assignment, row.outcome) for row in rows] == [
        (paper.student_id, paper.assignment, NEW) for paper in papers
    ]
    assert any(paper.package for paper in papers)
    for paper in papers:
        place = course.folder('submitted', paper.student_id, paper.assignment)
        came = {path for path in place.rglob('*') if path.is_file()}
        texts = {str(path.relative_to(place)): path.read_text() for path in came}
        package = {f'arm_player/{name}': text for name, text in paper.package.items()}
        assert texts == {f'{paper.assignment}.ipynb': paper.text} | package


def test_a_wrong_score_is_found(tmp_path, monkeypatch):
    names = ('00_two_link_arm-fail-no_inner_border', '00_two_link_arm-pass-numpy_bool')
    wrong = dict.fromkeys(EXPECTED[names[0]], 'expected False, saw True: mind the border')

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        [answer] = [cell.source for cell in notebook.cells if role(cell) == 'answer']
        reasons = {} if 'np.abs(l1 - l2)' in answer else wrong
        return Execution(notebook=executed(notebook, reasons), verdicts=(), notes=())

    stand_in(look, monkeypatch)
    monkeypatch.setattr(reuse, 'software_hash', lambda: 'the same code')  # hashing it takes long
    papers = synthetic_class(2, samples=names, seed=2)
    assert {paper.sample for paper in papers} == set(names)
    course = Course(gradebook=tmp_path)
    hand_in(course, papers)
    assert all(row.stored for row in grade_all(course, find_submissions(course)))
    assert wrong_scores(course, papers) == []

    others = [paper.sample for paper in reversed(papers)]
    swapped = [replace(paper, sample=other) for paper, other in zip(papers, others, strict=True)]
    assert len(wrong_scores(course, swapped)) >= 2
    assert f'({names[0]}): expected ' in ' '.join(wrong_scores(course, swapped))
    nobody = replace(papers[0], student_id='nobody')
    assert len(wrong_scores(course, [nobody])) == len(nobody.expected)
    assert 'the gradebook holds nothing' in wrong_scores(course, [nobody])[0]
