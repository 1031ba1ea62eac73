"""The page for instructors, followed step by step exactly as it is written."""

import csv
import json
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from fresh_machine import fresh_clone, fresh_environment
from synthetic_class import synthetic_class

from grader.authoring.bundle import FOLDER
from grader.course import ROOT

PAGE = (ROOT / 'docs/for-instructors.md').read_text(encoding='utf-8')
TABLE = PAGE[PAGE.index('| step | command |') :].partition('\n\n')[0]
STEPS = re.findall(r'^\| ([\w ]+) \| (.*?`.+?`.*?) \| (.+) \|$', TABLE, re.MULTILINE)
COMMANDS = [command for _, cell, _ in STEPS for command in re.findall(r'`(\./course .+?)`', cell)]
LESSONS = ('02_joint_state', '03_publisher')
STUDENTS = (
    *('Ada Lovelace', 'Bob Ross', 'Çelik Ayşe', 'Дмитрий Петров', 'Émile Zola'),
    *('Fatima al-Sayed', 'Grace Hopper', "Heather O'Neill", 'Ines Müller', '李军'),
)
"""Names as a course management system exports them."""


class Walk:
    """A new instructor in a fresh clone, with ten students."""

    def __init__(self, clone, environment):
        self.clone, self.environment = clone, environment
        self.archive = clone.parent / 'CS101-Homework 3-4711.zip'
        papers = synthetic_class(len(STUDENTS), assignments=LESSONS, seed=4)
        self.papers = dict(zip(STUDENTS, papers, strict=True))

    def course(self, command):
        """Run the command of a cell of the page; return its output and the name of its step."""
        _, verb, *arguments = re.sub(r' \[.*?\]', '', command).split()
        arguments = [str(self.archive) if a == 'FOLDER' else a for a in arguments]
        step = '_'.join([verb, *(a.strip('-') for a in arguments if a.startswith('--'))])
        return self.run('./course', verb, *arguments), step

    def run(self, *command):
        run = subprocess.run(
            command, cwd=self.clone, env=self.environment, capture_output=True, text=True
        )
        assert run.returncode == 0, f'{command}\n{run.stdout}\n{run.stderr}'
        return run.stdout

    def after_doctor(self, out):
        assert 'Nothing is missing' in out
        assert (self.clone / '.venv/bin/jupyter').is_file()

    def after_release(self, out):
        assert out == 'Nothing has changed.\n'

    def after_translate(self, out):
        """Nothing is left to do, and nothing has changed; a fresh clone has no history to ask."""
        assert not re.search('missing: |out of date: ', out)
        for path in (ROOT / 'locale').rglob('*.po'):
            assert (self.clone / path.relative_to(ROOT)).read_bytes() == path.read_bytes()

    def after_bundle(self, out):
        """Students unpack it and work in its notebooks; the system packs what they hand in."""
        assert out.startswith('students.zip: ')
        with zipfile.ZipFile(self.clone / 'students.zip') as bundle:
            for lesson in LESSONS:
                given = bundle.read(f'{FOLDER}/notebooks/{lesson}/{lesson}.ipynb')
                assert given == (ROOT / 'notebooks' / lesson / f'{lesson}.ipynb').read_bytes()
        with zipfile.ZipFile(self.archive, 'w') as archive:
            for number, (student, paper) in enumerate(self.papers.items(), start=8001):
                folder = f'{student}_{number}_assignsubmission_file'
                archive.writestr(f'{folder}/{paper.assignment}.ipynb', paper.text)

    def after_collect(self, out):
        assert '10 new; 0 not taken.' in out
        assert all(re.search(rf'^{re.escape(s)} .* new$', out, re.MULTILINE) for s in STUDENTS)

    def after_grade(self, out):
        assert '10 graded, 0 unchanged, 0 could not be graded (–); 0 wait' in out
        page = Path(re.search('^Report: (.+)$', out, re.MULTILINE)[1])
        assert 'What the class did not understand' in page.read_text(encoding='utf-8')
        report = json.loads(page.with_suffix('.json').read_text(encoding='utf-8'))
        assert report['counts']['graded now'] == 10
        assert report['environment']['isolation'] == 'each submission in a sandbox'

    def after_feedback(self, out):
        assert '10 pages in ' in out
        pages = self.clone.glob('gradebook/feedback/*/*/*.html')
        assert sorted(page.parts[-3] for page in pages) == sorted(STUDENTS)

    def after_scores(self, out):
        path = Path(out.strip())
        assert path == self.clone / 'gradebook/scores.csv'
        with path.open(encoding='utf-8-sig', newline='') as file:
            rows = list(csv.DictReader(file))
        found = {student: {} for student in STUDENTS}
        for row in rows:
            if row['comment'] != 'not submitted':
                found[row['student_id']][row['assignment'], row['grade_id']] = float(row['score'])
        assert found == {
            student: {(paper.assignment, name): score for name, score in paper.expected.items()}
            for student, paper in self.papers.items()
        }

    def after_scores_format(self, out):
        """The scores to be uploaded have the participant numbers of the download."""
        found = {}
        for path in map(Path, out.split('\n')[:-1]):
            with path.open(encoding='utf-8-sig', newline='') as file:
                found |= {row['Identifier']: float(row['Grade']) for row in csv.DictReader(file)}
        assert found == {
            f'Participant {number}': sum(paper.expected.values())
            for number, paper in enumerate(self.papers.values(), start=8001)
        }

    def after_feedback_zip(self, out):
        names = []
        for path in self.clone.glob('gradebook/moodle/*-feedback.zip'):
            with zipfile.ZipFile(path) as archive:
                names += archive.namelist()
        assert len(names) == len(STUDENTS)


def test_the_walk_checks_each_step_of_the_instructors_page():
    _, _, *rows = TABLE.splitlines()
    assert len(STEPS) == len(rows)
    steps = [re.sub(r' \[.*?\]', '', command).split()[1:] for command in COMMANDS]
    names = ['_'.join([s[0], *(a.strip('-') for a in s if a.startswith('--'))]) for s in steps]
    assert [name.removeprefix('after_') for name in vars(Walk) if 'after_' in name] == names


@pytest.mark.slow
@pytest.mark.isolation
@pytest.mark.timeout(3600)
def test_a_new_instructor_gets_from_the_bundle_to_the_scores(tmp_path):
    clone = fresh_clone(tmp_path / 'clone')
    walk = Walk(clone, fresh_environment(tmp_path))
    for command in COMMANDS:
        out, verb = walk.course(command)
        getattr(walk, f'after_{verb}')(out)

    # the page's claim about nbgrader's own commands
    said = ' '.join(PAGE.split())
    assert 'Its own commands (' in said
    assert '`export`) and its formgrader work in this folder and give the same scores' in said
    walk.run('.venv/bin/nbgrader', 'export')
    with (clone / 'grades.csv').open(encoding='utf-8', newline='') as file:
        totals = {
            (r['student_id'], r['assignment']): float(r['score']) for r in csv.DictReader(file)
        }
    for student, paper in walk.papers.items():
        assert totals[student, paper.assignment] == sum(paper.expected.values())
    shutil.rmtree(clone / '.venv')
