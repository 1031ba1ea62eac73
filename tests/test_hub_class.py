"""A real hub with two students and an instructor: what becomes of their work, who hears whom."""

import pytest
from chromium import drives_chromium, several_launched
from hub_browser import Kernel, end_kernels, log_in, wait_for_lab
from hub_machine import hub_machine, needs_root
from hub_nodes import LIST, LISTEN_AND_INJECT, LOOK_AROUND, MESSAGES, RUN
from playwright.sync_api import expect

pytestmark = [
    *drives_chromium,
    needs_root,
    pytest.mark.slow,
    pytest.mark.isolation,
    pytest.mark.timeout(2400),  # the first test sets the hub up
]


@pytest.fixture(scope='module')
def machine():
    with hub_machine() as machine:
        yield machine


@pytest.fixture(scope='module')
def pages(machine):
    """JupyterLab of each user, in a browser of their own."""
    users = (*machine.students, machine.instructor)
    with several_launched(len(users)) as browsers:
        pages = {
            user: log_in(browser, machine, user)
            for browser, user in zip(browsers, users, strict=True)
        }
        for page in pages.values():
            wait_for_lab(page)
        yield pages


@pytest.fixture
def kernel(machine, pages):
    """Begins a kernel of a student; all are ended."""
    yield lambda student: Kernel(pages[student])
    for student in machine.students:
        end_kernels(pages[student])


def test_students_log_in_with_their_password_and_begin_on_the_contents(machine, pages):
    for student in machine.students:
        page = pages[student]
        assert f'/user/{student}/lab/tree/index.ipynb' in page.url
        expect(page.get_by_role('link', name='core terms')).to_be_visible()


@pytest.mark.parametrize('turn', [1, -1], ids=['the_first', 'the_second'])
def test_a_student_neither_sees_nor_hears_nor_reaches_the_node_of_another(machine, kernel, turn):
    mine, theirs = machine.students[::turn]
    node = kernel(mine)
    node.run(RUN % {'name': mine})

    kernel(theirs).run(RUN % {'name': theirs})  # their tools see something
    names = kernel(theirs).run(LIST)
    assert f'node_of_{theirs}' in names
    assert mine not in names
    assert kernel(theirs).run(LISTEN_AND_INJECT % {'name': mine}) == 'False False\n'
    assert node.run('print(len(heard))') == '0\n'

    # and in one room all of that is possible
    assert {f'/node_of_{mine}', f'/talk_of_{mine}'} <= {*kernel(mine).run(LIST).split()}
    assert kernel(mine).run(LISTEN_AND_INJECT % {'name': mine}) == 'True True\n'
    assert node.run('print(len(heard))') == f'{MESSAGES}\n'


def test_a_student_sees_no_others_home_files_processes_or_sockets(machine, kernel):
    mine = machine.students[0]
    homes, files, owners, sockets = kernel(mine).run(LOOK_AROUND).splitlines()
    assert (homes, files) == (f"['{mine}']", '[]')
    assert owners == f"{{'{mine}'}}"
    assert sockets == '0'
