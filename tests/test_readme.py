"""The README is true: its commands, lessons, links, figures, examples and quoted words."""

import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from my_robot_basics.live.packages.workspace import BUILD
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

ROOT = Path(__file__).parents[1]
README = (ROOT / 'README.md').read_text(encoding='utf-8')
CHINESE = (ROOT / 'README.zh-CN.md').read_text(encoding='utf-8')
FOR_INSTRUCTORS = (ROOT / 'docs/for-instructors.md').read_text(encoding='utf-8')
CAPACITY = (ROOT / 'docs/capacity.md').read_text(encoding='utf-8')
MOST_LINES = 140
"""The README is an entrance, which a newcomer reads to its end."""
EXAMPLES = re.findall(r'^```python\n(.*?)^```', README, re.MULTILINE | re.DOTALL)
LESSONS = re.findall(r'^\| \[(\d\d) (.+?)\]\((.+?)\) \| .+? \| (\d+) \|$', README, re.MULTILINE)
LINKS = re.findall(r'\]\((?!https:)([^)#]+)\)|src="([^"]+)"', README)

ONE_HZ = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from my_robot_basics.live import run

node = run(Node, 'kinematics_publisher')
publisher = node.create_publisher(JointState, '/kinematics/joint_states', 10)
timer = node.create_timer(1.0, lambda: publisher.publish(JointState()))
"""


def test_the_readme_and_docs_name_exactly_the_verbs_of_course():
    usage = subprocess.run([ROOT / 'course', '--help'], capture_output=True, text=True).stdout
    verbs = set(re.findall(r'^  (\w+)', usage, re.MULTILINE))
    named = set(re.findall(r'\./course (\w+)', README + FOR_INSTRUCTORS))
    assert named - verbs == set()
    assert verbs - named == set()  # no verb is missing from the documentation


def test_every_nbgrader_command_exists():
    named = re.findall(r'`\.venv/bin/(\w+) (\w+)`(?:, `(\w+)`, `(\w+)`)?', FOR_INSTRUCTORS)
    named += [(program, '') for program in re.findall(r'\.venv/bin/(\w+)', README)]
    assert {program for program, *_ in named} == {'dask', 'jupyter', 'nbgrader'}
    assert all(Path(sys.prefix, 'bin', program).is_file() for program, *_ in named)
    from nbgrader.apps.nbgraderapp import NbGraderApp

    commands = {word for program, *words in named if program == 'nbgrader' for word in words}
    assert {'autograde', 'export'} <= commands
    assert commands - {''} - set(NbGraderApp.subcommands) == set()


def test_the_readme_is_short_enough_to_be_read():
    assert len(README.splitlines()) <= MOST_LINES
    assert len(CHINESE.splitlines()) <= MOST_LINES


# --- the path of an instructor -------------------------------------------------------------------


def commands_of(text):
    """Return what the terminal's blocks of a text call, without arguments and comments."""
    blocks = re.findall(r'^```sh\n(.*?)^```', text, re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    return [' '.join(line.split()[:2]) for line in lines]


def test_the_instructors_commands_follow_the_steps_in_docs_for_instructors():
    path = commands_of(README.partition('## For instructors')[2])
    table = FOR_INSTRUCTORS.partition('## The steps')[2].partition('\n\n## ')[0]
    rows = re.findall(r'^\| [\w ]+ \| (.+?) \| .+ \|$', table, re.MULTILINE)
    cells = [re.findall(r'`((?:\./course|\.venv/bin/jupyter) \w+)', row) for row in rows]
    steps = iter([command for commands in cells for command in commands])
    assert len(path) > 6
    assert [command for command in path if command not in steps] == []  # in this order


# --- measured figures ----------------------------------------------------------------------------

FIGURE = r'\d[\d,.]*\d|\d'
SUMS = re.compile(r'^- \*\*.+(?:\n  .+)*', re.MULTILINE)
"""The items of the README with figures: each names a script that measures them again."""


def without_links(text):
    return re.sub(r'\]\([^)]*\)', ']', text)


def figures_of(text):
    """Return the figures of a text, without those of the commands that repeat them."""
    return set(re.findall(FIGURE, re.sub('`.*?`', '', without_links(text))))


def test_each_figure_has_a_benchmark_and_is_in_docs_capacity():
    items = SUMS.findall(README)
    assert len(items) == 3
    sections = re.split(r'^## ', CAPACITY, flags=re.MULTILINE)
    for item in items:
        scripts = re.findall(r'tests/benchmarks/(\w+\.py)((?: --[a-z]+ \d+)*)', item)
        assert scripts
        told = [s for s in sections if any(f'benchmarks/{name}' in s for name, _ in scripts)]
        assert [
            options for _, options in scripts if not any(options.strip() in s for s in told)
        ] == []
        known = set(re.findall(FIGURE, ''.join(told)))
        assert figures_of(item) - known == set()


# --- the Chinese README --------------------------------------------------------------------------


def test_the_chinese_readme_has_the_same_sections_commands_and_figures():
    """The same sections, commands and measured figures, and a link to each document."""
    assert len(re.findall('^## ', CHINESE, re.MULTILINE)) == len(
        re.findall('^## ', README, re.MULTILINE)
    )
    parts = (text.split('\n## ')[1:] for text in (README, CHINESE))
    for english, chinese in zip(*parts, strict=True):
        assert commands_of(chinese) == commands_of(english)
    english, chinese = (SUMS.findall(text) for text in (README, CHINESE))
    assert [figures_of(item) for item in chinese] == [figures_of(item) for item in english]
    command = r'`(tests/benchmarks/.+?)`'
    assert re.findall(command, CHINESE) == re.findall(command, README)
    documents = r'\]\((\w+\.md|(?:docs|deploy)/[^)#]+)[^)]*\)'
    assert set(re.findall(documents, README)) - set(re.findall(documents, CHINESE)) == set()


def test_the_chinese_readme_links_to_each_translated_lesson():
    row = r'^\| \[(\d\d) (.+?)\]\(notebooks/(.*?)\) \| .+? \| (\d+) \|$'
    wanted = []
    for number, _, path, points in re.findall(row, README, re.MULTILINE):
        path = f'zh_CN/{path}'
        cells = nbformat.read(ROOT / 'notebooks' / path, as_version=4).cells
        title = cells[0].source.splitlines()[0].partition(' · ')[2].partition('：')[0]
        if not title.isascii():
            wanted.append((number, title, path, points))
    assert wanted
    assert re.findall(row, CHINESE, re.MULTILINE) == wanted


def test_the_readmes_link_to_one_another_and_to_files_that_exist():
    assert '(README.zh-CN.md)' in README.partition('## ')[0]
    assert '(README.md)' in CHINESE.partition('## ')[0]
    links = re.findall(r'\]\((?!https:)([^)#]+)[^)]*\)|src="([^"]+)"', CHINESE)
    assert [
        link for pair in links for link in filter(None, pair) if not (ROOT / link).is_file()
    ] == []


def test_the_chinese_readme_has_the_commands_and_code_of_the_english_readme():
    verbs = set(re.findall(r'\./course (\w+)', README))
    assert set(re.findall(r'\./course (\w+)', CHINESE)) - verbs == set()
    code = [
        [line.partition('  #')[0] for block in blocks for line in block.splitlines()]
        for blocks in (
            re.findall(r'^```python\n(.*?)^```', text, re.MULTILINE | re.DOTALL)[:1]
            for text in (README, CHINESE)
        )
    ]
    assert code[0] == code[1]


def test_the_table_lists_all_lessons_with_their_points():
    rows = {}
    for path in sorted((ROOT / 'solutions').glob('*/*.ipynb')):
        cells = nbformat.read(path, as_version=4).cells
        points = sum(c.metadata.get('nbgrader', {}).get('points', 0) for c in cells)
        title = cells[0].source.splitlines()[0].removeprefix('# ')
        rows[f'notebooks/{path.parent.name}/{path.name}'] = (title, points)
    assert rows
    assert [link for _, _, link, _ in LESSONS] == list(rows)
    for number, title, link, points in LESSONS:
        assert Path(link).name.startswith(number)
        written, worth = rows[link]
        # the table may shorten what the lesson's title adds after a colon
        assert re.fullmatch(rf'{int(number)} · {re.escape(title)}(: .+)?', written)
        assert int(points) == worth


@pytest.mark.parametrize('link', sorted({first or second for first, second in LINKS}))
def test_links_and_pictures_lead_to_existing_files(link):
    assert (ROOT / link).is_file()


def test_each_path_in_the_table_of_folders_exists():
    rows = README.partition('## What is where')[2].partition('\n## ')[0]
    named = re.findall(r'`([^`]+)`', ' '.join(re.findall(r'^\| (`.+?) \|', rows, re.MULTILINE)))
    assert len(named) > 5
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_lines_for_a_terminal_are_those_that_the_workspace_prints():
    (block,) = re.findall(r'^```sh\n(cd .*?)^```', README, re.MULTILINE | re.DOTALL)
    *lines, run = block.splitlines()
    assert ' && '.join(lines) == BUILD
    assert run == 'ros2 run my_robot_basics kinematics_publisher'


def run_cells(*sources, allow_errors=False):
    notebook = new_notebook(cells=[new_code_cell(source) for source in sources])
    client = NotebookClient(notebook, timeout=60, kernel_name='python3', allow_errors=allow_errors)
    client.execute()
    return [[dict(output) for output in cell.outputs] for cell in notebook.cells]


def test_the_first_example_shows_the_arm():
    (outputs,) = run_cells(EXAMPLES[0])
    assert any('image/png' in output.get('data', {}) for output in outputs)
    assert [output for output in outputs if output.get('name') == 'stderr'] == []


def test_the_check_of_the_example_fails_with_the_quoted_words():
    (quoted,) = re.findall(r'explains itself: \*(.+?)\*', README, re.DOTALL)
    check = EXAMPLES[1].replace('60.0', '10.0')
    assert check != EXAMPLES[1]
    *_, failed = run_cells(ONE_HZ, check, allow_errors=True)
    (error,) = (output for output in failed if output['output_type'] == 'error')
    assert error['evalue'] == ' '.join(quoted.split())
