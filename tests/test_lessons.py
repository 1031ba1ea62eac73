"""The form of the lessons: their length, their metadata, and what a cell may depend on."""

import ast
import builtins
import re
from pathlib import Path
from statistics import median
from types import ModuleType

import nbformat
import pytest
from IPython.core.inputtransformer2 import TransformerManager

from grader.authoring.release_passes import uncomment_broken_lines

ROOT = Path(__file__).parents[1]
SOURCES = sorted(ROOT.glob('solutions/*/*.ipynb'))

CONTRACT = {
    '00_two_link_arm': {
        'reach': ('is_reachable', {'reach-visible': 1, 'reach-hidden': 2}),
    },
    '01_topics': {
        'predict_delivery': ('predict_delivery', {'predict_delivery-check': 2}),
    },
    '02_joint_state': {
        'to_joint_state': (
            'to_joint_state',
            {'radians': 2, 'joint_names': 1, 'header_stamp': 1},
        ),
    },
    '03_publisher': {
        'five_hz': ('KinematicsPublisher', {'five_hz_rate': 3, 'five_hz_messages': 2}),
    },
    '04_subscriber': {
        'ik_solver_node': (
            'IKSolverNode',
            {'ik_solver_answers': 3, 'ik_solver_unreachable': 2},
        ),
    },
    '05_command_line': {
        'find_endpoints': ('endpoints', {'find_endpoints_counts': 2}),
        'explain_counts': (None, {'explain_counts': 2}),
    },
    '06_qos': {
        'compatible_qos': (
            'JointStateMonitor',
            {'compatible_qos_delivery': 2, 'compatible_qos_late_joiner': 2},
        ),
    },
    '07_common_errors': {
        'fix_topic_name': ('ArmListener', {'fix_topic_name-fixed': 2}),
        'fix_units': ('DegreesToJointState', {'fix_units-fixed': 2}),
        'fix_stamp': ('StampedPublisher', {'fix_stamp-fixed': 2}),
    },
    '08_services': {
        'ik_service': ('IKService', {'ik_service_answers': 2, 'ik_service_unreachable': 1}),
        'ik_client': ('IKClient', {'ik_client_asks': 2, 'ik_client_never_blocks': 2}),
    },
    '09_actions': {
        'move_arm_server': (
            'MoveArmServer',
            {
                'move_arm_reaches': 2,
                'move_arm_feedback': 1,
                'move_arm_cancels': 2,
                'move_arm_rejects': 1,
            },
        ),
        'move_arm_client': (
            'MoveArmClient',
            {'move_arm_client_outcomes': 2, 'move_arm_client_cancels': 2},
        ),
    },
    '10_interfaces': {
        'count_turns': ('turns_msg', {'count_turns_fields': 3}),
    },
    '11_parameters': {
        'adjustable_rate': (
            'AdjustablePublisher',
            {'adjustable_rate_follows': 2, 'adjustable_rate_refuses': 1},
        ),
        'two_arms': ('left_arm', {'two_arms_graph': 2}),
    },
    '12_package': {
        'arm_player': (
            None,
            {'package_builds': 1, 'package_runs': 2, 'arm_player_plays': 4},
        ),
    },
}
"""Assignment -> exercise -> (the name that its answer defines, its grade cells' points)."""

WITHOUT_HIDDEN_PART = {'reach-visible', 'joint_names', 'explain_counts', 'package_builds'}
"""Grade cells that show all they check."""
WITH_RUN_CELL = {
    *('five_hz', 'ik_solver_node', 'find_endpoints', 'compatible_qos'),
    *('fix_topic_name', 'fix_units', 'fix_stamp', 'ik_service', 'ik_client'),
    *('move_arm_server', 'move_arm_client'),
    *('adjustable_rate', 'two_arms'),
}
"""Exercises for which a locked cell starts nodes."""
BY_HAND = {'explain_counts'}
"""Exercises whose answer is a text that a person grades: one cell is all there is to them."""

BY_FOLDER = {'arm_player'}
"""Exercises whose answer is a folder beside the notebook: a locked cell builds it."""

pytestmark = pytest.mark.parametrize('path', SOURCES, ids=lambda path: path.stem)


@pytest.fixture
def lesson(path):
    return nbformat.read(path, as_version=4)


def test_every_lesson_is_listed_in_the_contract(path):
    assert path.stem in CONTRACT
    assert path.parent.name == path.stem


# --- length and language -------------------------------------------------------------------------


def test_lesson_has_20_to_40_cells(lesson):
    assert 20 <= len(lesson.cells) <= 40


MARK_SCHEME = re.compile('### BEGIN MARK SCHEME.*?### END MARK SCHEME', re.DOTALL)
"""What only instructors read."""


def test_prose_has_20_to_60_words_a_cell(lesson):
    texts = [cell for cell in lesson.cells if cell.cell_type == 'markdown']
    wordy = {cell.id: words(MARK_SCHEME.sub('', cell.source)) for cell in texts}
    assert {id_: n for id_, n in wordy.items() if not 20 <= n <= 60} == {}


def test_code_is_short(lesson):
    lines = {cell.id: len(as_released(cell.source).splitlines()) for cell in code_cells(lesson)}
    assert {id_: n for id_, n in lines.items() if n > 25} == {}
    assert median(lines.values()) <= 8


def test_answers_are_short(lesson):
    answers = [cell for cell in code_cells(lesson) if marks(cell).get('solution')]
    lines = {cell.id: len(cell.source.splitlines()) for cell in answers}
    assert {id_: n for id_, n in lines.items() if n > 60} == {}


def test_lesson_opens_with_its_contract_and_closes_with_points_and_the_next_lesson(lesson, path):
    first, last = lesson.cells[0].source, lesson.cells[-1].source
    assert first.startswith(f'# {int(path.stem[:2])} · ')
    assert 'You will be able to' in first
    following = [name for name in sorted(CONTRACT) if name > path.stem]
    the_way_on = f'../{following[0]}/{following[0]}.ipynb' if following else '../what_next.md'
    assert f']({the_way_on})' in last
    for exercise, (_, grade_cells) in CONTRACT[path.stem].items():
        assert f'| `{exercise}` | {sum(grade_cells.values())} |' in first
        for grade_id, points in grade_cells.items():
            assert f'| `{grade_id}` | {points} |' in last


EXERCISE_MIN = 4
"""Minutes for each point of an exercise."""


def test_opening_names_required_lessons_and_the_estimated_time(lesson, path):
    """An estimate: to read, with the code; to predict and run each demonstration; to answer."""
    row = r'\| you need \| time \|\n\|---\|---\|\n\| (.+) \| about (\d+) minutes \|'
    needs, minutes = re.search(row, lesson.cells[0].source).groups()
    earlier = [int(number) for number in re.findall(r'\d', needs)]
    assert earlier or path.stem.startswith('00')
    assert all(number < int(path.stem[:2]) for number in earlier)
    demos = [c for c in lesson.cells if 'demo' in c.metadata.get('tags', [])]
    lines = sum(len(visible_part(cell.source).splitlines()) for cell in code_cells(lesson))
    points = sum(marks(cell).get('points', 0) for cell in lesson.cells)
    reading_min = len(prose(lesson).split()) / 200 + lines / 20
    estimate = reading_min + len(demos) + EXERCISE_MIN * points
    assert int(minutes) % 5 == 0
    assert abs(int(minutes) - estimate) <= 10, estimate


def test_the_prompt_of_an_exercise_names_its_points(lesson, path):
    headings = re.findall(r'^## Exercise: `(\w+)` \((\d+) points', prose(lesson), re.MULTILINE)
    points = {name: sum(cells.values()) for name, (_, cells) in CONTRACT[path.stem].items()}
    assert {name: int(number) for name, number in headings} == points


def test_most_demonstrations_come_after_a_prediction(lesson):
    told, predicted = '', []
    for cell in lesson.cells:
        if cell.cell_type == 'markdown':
            told = cell.source
        elif 'demo' in cell.metadata.get('tags', []):
            predicted.append(bool(re.search(r'\b(predict|guess)\b', told, re.IGNORECASE)))
    assert sum(predicted) > len(predicted) / 2


def test_links_lead_to_files_that_are_given_out(lesson, path):
    folder = ROOT / 'notebooks' / path.stem
    links = re.findall(r'\]\((?!https://)([^)]+)\)', prose(lesson))
    assert {link for link in links if not (folder / link).is_file()} == set()


def prose(lesson):
    return '\n'.join(cell.source for cell in lesson.cells if cell.cell_type == 'markdown')


def words(markdown):
    """Count the words that are read in a line: not tables, code blocks or addresses."""
    text = re.sub(r'```.*?```', '', markdown, flags=re.DOTALL)
    text = re.sub(r'\]\([^)]*\)', ']', text)
    lines = [line for line in text.splitlines() if not line.startswith('|')]
    return len(re.findall(r'\w[\w.\'’-]*', ' '.join(lines)))


# --- metadata ------------------------------------------------------------------------------------


def test_notebook_metadata_is_the_agreed_minimum(lesson):
    assert lesson.metadata == {
        'kernelspec': {
            'display_name': 'Python 3 (ipykernel)',
            'language': 'python',
            'name': 'python3',
        },
        'language_info': {'name': 'python'},
    }
    assert (lesson.nbformat, lesson.nbformat_minor) == (4, 5)


def test_cell_metadata_is_on_the_allow_list(lesson):
    for cell in lesson.cells:
        assert set(cell.metadata) <= {'nbgrader', 'tags'}, cell.id
        for tag in cell.metadata.get('tags', []):
            assert tag == 'demo' or tag.startswith('nbval-'), cell.id


def test_cell_ids_are_unique_and_readable(lesson):
    ids = [cell.id for cell in lesson.cells]
    assert len(set(ids)) == len(ids)
    for cell in lesson.cells:
        assert re.fullmatch(r'[a-z][a-z0-9_]*(-[a-z]+)?', cell.id)
        assert cell.id == marks(cell).get('grade_id', cell.id)


def test_cells_with_ignored_outputs_are_few_and_say_why(lesson):
    ignored = [c for c in lesson.cells if 'nbval-ignore-output' in c.metadata.get('tags', [])]
    assert len(ignored) <= 2
    for cell in ignored:
        assert re.search(r'^# .*differs? each time', cell.source, re.MULTILINE), cell.id


# --- exercises -----------------------------------------------------------------------------------


def test_exercises_keep_their_contract(lesson, path):
    graded = {c.id: marks(c)['points'] for c in lesson.cells if marks(c).get('grade')}
    expected = {}
    for _, grade_cells in CONTRACT[path.stem].values():
        expected |= grade_cells
    assert graded == expected
    hidden = {c.id for c in lesson.cells if marks(c).get('grade') and has_hidden_part(c)}
    assert hidden == set(expected) - WITHOUT_HIDDEN_PART


def test_cells_of_an_exercise_stand_in_order(lesson, path):
    ids = [cell.id for cell in lesson.cells]
    for exercise, (_, grade_cells) in CONTRACT[path.stem].items():
        run = [f'{exercise}-run'] if exercise in WITH_RUN_CELL else []
        order = [f'{exercise}-reset', exercise, *run, f'{exercise}-try', *grade_cells]
        if exercise in BY_HAND:
            order = [exercise]
        start = ids.index(order[0])
        assert ids[start : start + len(order)] == order
        assert lesson.cells[start - 1].cell_type == 'markdown'
        unmarked = [c.id for c in lesson.cells[start : start + len(order)] if not marks(c)]
        assert unmarked == [f'{exercise}-try'] * (exercise not in BY_HAND)


def test_only_answers_are_unlocked_and_only_grade_cells_have_points(lesson, path):
    answers = set(CONTRACT[path.stem]) - BY_FOLDER
    for cell in lesson.cells:
        mark = marks(cell)
        if not mark:
            continue
        assert mark['solution'] == (cell.id in answers)
        assert mark['locked'] == (cell.id not in answers)
        assert mark['grade'] == ('points' in mark)
        assert mark['schema_version'] == 3
        assert not mark['task']


def test_no_teaching_cell_binds_the_name_of_an_answer(lesson, path):
    names = {name for name, _ in CONTRACT[path.stem].values()}
    for cell in code_cells(lesson):
        if not marks(cell).get('solution'):
            assert not names & bound(cell), cell.id


def test_a_demo_binds_nothing_that_later_cells_need(lesson):
    shown = set()
    for cell in code_cells(lesson):
        if 'demo' in cell.metadata.get('tags', []):
            assert not marks(cell), cell.id
            shown |= bound(cell)
        else:
            assert not shown & needed(cell), cell.id


def test_a_grade_cell_has_a_docstring_and_needs_no_name_of_the_lesson(lesson):
    for cell in code_cells(lesson):
        if not marks(cell).get('grade'):
            continue
        for source in (cell.source, visible_part(cell.source)):
            assert ast.get_docstring(ast.parse(source)), cell.id
            assert needed_by(source) == set(), cell.id


def test_each_check_that_a_grade_cell_calls_exists(lesson):
    """A check that was renamed would stop the cell at grading, and give no verdict."""
    for cell in code_cells(lesson):
        if not marks(cell).get('grade'):
            continue
        nodes = list(ast.walk(ast.parse(cell.source)))
        imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
        there = {}
        exec(ast.unparse(ast.Module(imports, [])), there)  # fails where a name is missing
        for node in nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                owner = there.get(node.value.id)
                if isinstance(owner, ModuleType):
                    assert hasattr(owner, node.attr), f'{cell.id}: {ast.unparse(node)}'


def test_publishers_of_joint_states_set_stamp_and_frame_or_say_why_not(lesson):
    """Nodes that publish joint states set stamp and frame, or a comment says that they do not."""
    for cell in code_cells(lesson):
        source = TransformerManager().transform_cell(cell.source)
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ClassDef):
                text = '\n'.join(source.splitlines()[node.lineno - 1 : node.end_lineno])
                if 'JointState(' in text and not re.search(r'#.*\bno stamp\b', text):
                    assert re.search(r'header\.stamp =|stamp=', text), (cell.id, node.name)
                    assert 'frame_id' in text, (cell.id, node.name)


def test_no_comment_points_at_the_line_that_is_to_be_fixed(lesson):
    """Hints are above the node; none is at the broken line or next to it."""
    for cell in code_cells(lesson):
        if '### BROKEN' in cell.source:
            released = uncomment_broken_lines(as_released(cell.source))
            first = released[: released.index('class ')].splitlines()
            assert all(line.startswith('# ') for line in first), cell.id
            assert '#' not in released[released.index('class ') :], cell.id


def test_an_untouched_answer_is_valid_python_with_hints(lesson):
    for cell in code_cells(lesson):
        if marks(cell).get('solution'):
            released = uncomment_broken_lines(as_released(cell.source))
            ast.parse(released)
            assert '# 1. ' in released, cell.id
            is_to_be_fixed = '### BROKEN' in cell.source
            assert ('YOUR CODE HERE' in released) != is_to_be_fixed, cell.id


def marks(cell):
    return cell.metadata.get('nbgrader', {})


def code_cells(lesson):
    return [cell for cell in lesson.cells if cell.cell_type == 'code']


def has_hidden_part(cell):
    return cell.source != visible_part(cell.source)


def visible_part(source):
    return re.sub(r'### BEGIN HIDDEN TESTS.*?### END HIDDEN TESTS\n?', '', source, flags=re.DOTALL)


def as_released(source):
    return re.sub(
        r'( *)### BEGIN SOLUTION.*?### END SOLUTION',
        r'\1# YOUR CODE HERE',
        visible_part(source),
        flags=re.DOTALL,
    )


def bound(cell):
    """The names that a cell leaves behind."""
    return _names(cell.source)[0] if not cell.source.startswith('%%') else set()


def needed(cell):
    """The names that a cell expects to find."""
    return needed_by(cell.source) if not cell.source.startswith('%%') else set()


def needed_by(source):
    stored, loaded = _names(source)
    return loaded - stored - set(dir(builtins)) - {'get_ipython'}


def _names(source):
    """All names that are bound anywhere in the source, and all that are read."""
    stored, loaded = set(), set()
    for node in ast.walk(ast.parse(TransformerManager().transform_cell(source))):
        match node:
            case ast.Name(id=name, ctx=ast.Load()):
                loaded.add(name)
            case ast.Name(id=name) | ast.arg(arg=name):
                stored.add(name)
            case ast.alias(name=name, asname=alias):
                stored.add(alias or name.split('.')[0])
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                stored.add(name)
    return stored, loaded


# --- stored outputs ------------------------------------------------------------------------------


def test_stored_outputs_are_those_of_one_clean_run(lesson):
    counts = [cell.execution_count for cell in code_cells(lesson)]
    assert counts == list(range(1, len(counts) + 1))
    for cell in code_cells(lesson):
        for output in cell.outputs:
            assert output.output_type != 'error', cell.id
            assert output.get('name') != 'stderr', cell.id


def test_stored_outputs_contain_no_path_of_a_machine(lesson):
    for cell in code_cells(lesson):
        for output in cell.outputs:
            text = str({k: v for k, v in output.get('data', {}).items() if 'image' not in k})
            text += output.get('text', '')
            assert not re.search(r'/(home|root|tmp|work|var|usr)/', text), cell.id
