"""What we rely on in nbgrader: an upgrade that changes it fails here before a grade does."""

import inspect
from pathlib import Path

import nbformat
import pytest
from course_maker import make_course
from nbconvert.exporters import Exporter
from nbformat.v4 import new_code_cell, new_markdown_cell, new_output
from nbgrader import utils
from nbgrader.apps.api import NbGraderAPI
from nbgrader.converters import Autograde, GenerateAssignment
from nbgrader.converters.base import BaseConverter
from nbgrader.coursedir import CourseDirectory
from nbgrader.preprocessors import Execute, OverwriteCells, SaveAutoGrades
from nbgrader.validator import Validator
from traitlets.config import Config
from traitlets.config.loader import PyFileConfigLoader

from grader.storage.pipeline import AUTOGRADE_PASSES, SANITIZE_PASSES


def names(passes):
    return [each if isinstance(each, str) else each.__name__ for each in passes]


DEFAULTS = {
    'sanitize': (
        Autograde().sanitize_preprocessors,
        'ClearOutput DeduplicateIds OverwriteKernelspec OverwriteCells CheckCellMetadata',
    ),
    'autograde': (
        Autograde().autograde_preprocessors,
        'Execute IgnorePattern ClearMetadataPreprocessor LimitOutput SaveAutoGrades '
        'AssignLatePenalties CheckCellMetadata',
    ),
    'release': (
        GenerateAssignment().preprocessors,
        'IncludeHeaderFooter InstantiateTests LockCells ClearSolutions ClearOutput '
        'CheckCellMetadata ComputeChecksums SaveCells ClearHiddenTests ClearMarkScheme '
        'ComputeChecksums CheckCellMetadata',
    ),
    'validate': (Validator().preprocessors, 'CheckCellMetadata ClearOutput Execute'),
}


@pytest.mark.parametrize(('passes', 'expected'), DEFAULTS.values(), ids=DEFAULTS)
def test_the_default_passes_of_nbgrader_are_the_expected_ones(passes, expected):
    assert names(passes) == expected.split()


def test_nbgrader_validate_always_runs_its_own_passes_with_30_s_a_cell():
    assert not Validator.class_traits()['preprocessors'].metadata.get('config')
    assert Execute().timeout == 30
    assert Execute().allow_errors is True


ERROR = new_output('error', ename='CheckFailed', evalue='no', traceback=['no'])
PRINTED = new_output('stream', name='stdout', text='x')
LOGGED = new_output('stream', name='stderr', text='x')
SHOWN = new_output('display_data', {'text/plain': '0'})


def result(text):
    return new_output('execute_result', {'text/plain': text})


GRADES = {
    'silence earns all': ([], 3.0),
    'prints earn all': ([PRINTED, SHOWN], 3.0),
    'an error earns none': ([PRINTED, SHOWN, ERROR], 0),
    'stderr earns none': ([LOGGED], 0),
    'a number earns itself': ([result('1.5')], 1.5),
    'another value earns all': ([result('[1, 2]')], 3.0),
    'a value before an error earns itself': ([result('2'), ERROR], 2.0),
}


@pytest.mark.parametrize(('outputs', 'points'), GRADES.values(), ids=GRADES)
def test_determine_grade_takes_points_from_the_outputs_of_a_cell(outputs, points):
    marks = {'grade': True, 'solution': False, 'grade_id': 'a', 'points': 3}
    cell = new_code_cell('x', metadata={'nbgrader': marks}, outputs=outputs)
    assert utils.determine_grade(cell) == (points, 3.0)


def test_determine_grade_gives_no_score_to_a_changed_manual_answer():
    marks = {'grade': True, 'solution': True, 'grade_id': 'a', 'points': 2, 'schema_version': 3}
    cell = new_markdown_cell('stub', metadata={'nbgrader': marks})
    cell.metadata.nbgrader['checksum'] = utils.compute_checksum(cell)
    assert utils.determine_grade(cell) == (0, 2.0)
    cell.source = 'an answer'
    assert utils.determine_grade(cell) == (None, 2.0)


CELLS = {
    'grade': ({'grade': True, 'solution': False}, (True, False, True)),
    'answer': ({'grade': False, 'solution': True}, (False, True, False)),
    'manual': ({'grade': True, 'solution': True}, (True, True, False)),
    'locked': ({'grade': False, 'solution': False, 'locked': True}, (False, False, True)),
}


@pytest.mark.parametrize(('marks', 'expected'), CELLS.values(), ids=CELLS)
def test_nbgrader_recognises_grade_solution_and_locked_cells(marks, expected):
    cell = new_code_cell('', metadata={'nbgrader': marks})
    assert (utils.is_grade(cell), utils.is_solution(cell), utils.is_locked(cell)) == expected


def test_passes_receive_the_submission_and_its_folder(tmp_path):
    course = CourseDirectory(root=str(tmp_path), db_url='sqlite:///x.db', assignment_id='a')
    course.submitted_directory = 'gradebook/submitted'
    path = tmp_path / 'gradebook/submitted/李雷/a/a.ipynb'
    path.parent.mkdir(parents=True)
    nbformat.write(nbformat.v4.new_notebook(), path)
    converter = Autograde(coursedir=course)
    resources = converter.init_single_notebook_resources(str(path))
    assert resources['nbgrader'] == {
        'student': '李雷',
        'assignment': 'a',
        'notebook': 'a',
        'db_url': 'sqlite:///x.db',
    }
    seen = []

    def note(notebook, resources):
        seen.append(resources)
        return notebook, resources

    exporter = Exporter(config=Config({'Exporter': {'default_preprocessors': []}}))
    exporter.register_preprocessor(note, enabled=True)
    exporter.from_filename(str(path), resources=resources)
    assert seen[0]['metadata']['path'] == str(path.parent)


@pytest.fixture
def config(tmp_path):
    course = make_course(tmp_path)
    return PyFileConfigLoader('nbgrader_config.py', path=str(course.root)).load_config()


def test_the_command_and_the_formgrader_both_use_the_configured_passes(config):
    converter = Autograde(parent=NbGraderAPI(config=config))  # as NbGraderAPI.autograde makes it
    command = Autograde(config=config)
    for each in (converter, command):
        assert tuple(each.sanitize_preprocessors) == SANITIZE_PASSES
        assert tuple(each.autograde_preprocessors) == AUTOGRADE_PASSES
    assert 'app = Autograde(coursedir=self.coursedir, parent=self)' in inspect.getsource(
        NbGraderAPI.autograde
    )


def test_the_configured_passes_are_registered_and_enabled(config):
    converter = Autograde(config=config)
    converter.exporter = Exporter(config=Config({'Exporter': {'default_preprocessors': []}}))
    for sanitizing, expected in ((True, SANITIZE_PASSES), (False, AUTOGRADE_PASSES)):
        converter._sanitizing = sanitizing
        converter._init_preprocessors()
        found = [type(p) for p in converter.exporter._preprocessors]
        assert [f'{p.__module__}.{p.__name__}'.split('.')[-1] for p in found] == [
            name.split('.')[-1] for name in expected
        ]
        assert all(p.enabled for p in converter.exporter._preprocessors)
        assert Execute not in found


def test_restoring_is_the_first_pass_and_execution_precedes_saving_scores():
    assert SANITIZE_PASSES[0] == 'grader.autograde.preprocessors.RestoreSubmission'
    assert 'nbgrader.preprocessors.Execute' not in AUTOGRADE_PASSES
    run = AUTOGRADE_PASSES.index('grader.autograde.preprocessors.ExecuteRooms')
    assert run < AUTOGRADE_PASSES.index('grader.storage.save_grades.SaveGrades')


def test_the_methods_that_save_grades_overrides_exist_in_nbgrader():
    for name in ('preprocess', 'preprocess_cell', '_add_score', '_add_comment'):
        assert callable(getattr(SaveAutoGrades, name))
    assert '_add_score(cell, resources)' in inspect.getsource(SaveAutoGrades.preprocess_cell)


def test_autograde_converts_each_notebook_twice_reading_it_from_its_file():
    # the method itself, without the gradebook's lock around it
    source = (
        Path(inspect.getsourcefile(Autograde)).read_text().split('def convert_single_notebook')[1]
    )
    first, second = source.split('self._sanitizing = False')
    assert 'super(Autograde, self).convert_single_notebook(notebook_filename)' in first
    assert 'super(Autograde, self).convert_single_notebook(notebook_filename)' in second
    assert 'exporter.from_filename' in inspect.getsource(BaseConverter.convert_single_notebook)


def test_overwrite_cells_of_nbgrader_looks_for_locked_cells():
    assert 'is_locked' in inspect.getsource(OverwriteCells)
