"""A real hub with two students and an instructor: their work, and which nodes each can reach."""

import time

import pytest
from answered import read
from chromium import LONG, drives_chromium, several_launched
from hub_browser import (
    AssignmentList,
    Kernel,
    answer,
    end_kernels,
    log_in,
    open_formgrader,
    score_by_hand,
    wait_for_lab,
)
from hub_machine import hub_machine, needs_root
from hub_nodes import BUILD, COMMAND, LIST, LISTEN_AND_INJECT, LOOK_AROUND, MESSAGES, RUN
from lab_browser import Lesson, close_all, see_the_arm_move
from playwright.sync_api import expect

pytestmark = [
    *drives_chromium,
    needs_root,
    pytest.mark.slow,
    pytest.mark.isolation,
    pytest.mark.timeout(2400),  # the first test sets the hub up
]

LESSON, ANSWER, WRITTEN = '05_command_line', 'find_endpoints', 'explain_counts'
RIGHT = next(cell.source for cell in read('solutions', LESSON).cells if cell.id == ANSWER)
WRONG = "endpoints = {'publishers': [], 'subscriptions': []}"
TEXT = 'The simulation counts, too, says %s.'
COMMENTS = ('Right. Which node is it?', 'What does it do there?')


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


@pytest.fixture(scope='module')
def in_checkout(machine, pages):
    """Runs commands as the instructor does in their JupyterLab."""
    kernel = Kernel(pages[machine.instructor])
    return lambda command: kernel.run(COMMAND % command)


@pytest.fixture
def kernel(machine, pages):
    """Starts a kernel of a student; all kernels are ended after the test."""
    yield lambda student: Kernel(pages[student])
    for student in machine.students:
        end_kernels(pages[student])


def test_students_log_in_with_their_password_and_begin_on_the_contents(machine, pages):
    for student in machine.students:
        page = pages[student]
        assert f'/user/{student}/lab/tree/index.ipynb' in page.url
        expect(page.get_by_role('link', name='core terms')).to_be_visible()


@pytest.mark.parametrize('turn', [1, -1], ids=['the_first', 'the_second'])
def test_a_student_s_node_is_not_visible_or_reachable_from_another_room(machine, kernel, turn):
    mine, theirs = machine.students[::turn]
    node = kernel(mine)
    node.run(RUN % {'name': mine})

    kernel(theirs).run(RUN % {'name': theirs})  # their tools see something
    names = kernel(theirs).run(LIST % {'name': theirs})
    assert {f'/node_of_{theirs}', f'/talk_of_{theirs}'} <= {*names.split()}
    reached = kernel(theirs).run(LISTEN_AND_INJECT % {'name': mine})
    arrived = int(node.run('print(len(heard))'))
    assert (mine in names, reached, arrived) == (False, 'False False\n', 0)

    # and in one room all of that is possible
    names = kernel(mine).run(LIST % {'name': mine})
    assert {f'/node_of_{mine}', f'/talk_of_{mine}'} <= {*names.split()}
    assert kernel(mine).run(LISTEN_AND_INJECT % {'name': mine}) == 'True True\n'
    assert node.run('print(len(heard))') == f'{MESSAGES}\n'


def test_a_student_sees_no_home_files_processes_or_sockets_of_others(machine, kernel):
    mine = machine.students[0]
    homes, files, owners, sockets = kernel(mine).run(LOOK_AROUND).splitlines()
    assert (homes, files) == (f"['{mine}']", '[]')
    assert owners == f"{{'{mine}'}}"
    assert sockets == '0'


def test_a_room_builds_the_workspace_and_shows_the_live_arm(machine, pages, kernel):
    mine = machine.students[0]
    said = kernel(mine).run(BUILD)
    assert f'\nbuilt /home/{mine}/lessons/ros_ws/install/my_robot_basics' in said
    see_the_arm_move(Lesson(pages[mine], 'arm/03_publisher.ipynb'))
    close_all(pages[mine])


# --- a lesson from its release to its feedback --------------------------------------------------


@pytest.fixture(scope='module')
def handed_in(machine, pages, in_checkout):
    """Fetch, answer, validate and submit both students' notebooks; give the words of Validate."""
    in_checkout(f'.venv/bin/nbgrader release_assignment {LESSON}')
    said = {}
    for student, text in zip(machine.students, (RIGHT, WRONG), strict=True):
        page = pages[student]
        AssignmentList(page).fetch(LESSON)
        lesson = Lesson(page, f'{LESSON}/{LESSON}.ipynb')
        answer(lesson, ANSWER, text)
        answer(lesson, WRITTEN, TEXT % student)
        said[student] = lesson.validate()
        close_all(page)
        AssignmentList(page).submit(LESSON)
    return said


def test_validate_in_a_room_tells_right_from_wrong(machine, handed_in):
    right, wrong = map(handed_in.get, machine.students)
    assert 'All visible checks pass' in right
    assert 'expected 2 publishers, saw 0' in wrong


def released(machine):
    """The pages of feedback in the exchange."""
    return {*machine.of_course.glob('feedback/*.html')}


@pytest.fixture(scope='module')
def served(machine, handed_in):
    """`./course serve`, which has released the feedback of all that was handed in."""
    with machine.serving() as log:
        deadline = time.monotonic() + 5 * LONG / 1000
        while len(released(machine)) < len(machine.students):
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.5)
        yield log


def test_each_student_reads_their_own_feedback_in_jupyterlab(machine, pages, served):
    for student, points in zip(machine.students, (2, 0), strict=True):
        said = AssignmentList(pages[student]).open_feedback(LESSON)
        assert f'Feedback for {student} · {LESSON} {points} of 4 points' in said
        assert f'Your answer {TEXT % student} Your written answer … waiting' in said
        assert not [other for other in machine.students if other != student and other in said]


@pytest.fixture(scope='module')
def scored_by_hand(machine, pages, served, in_checkout):
    """Points and comment for each student's text, which the instructor gave and released."""
    given = {'1.5': COMMENTS[0], '0.5': COMMENTS[1]}
    points = dict(zip(machine.students, given.items(), strict=True))
    formgrader = open_formgrader(pages[machine.instructor])
    score_by_hand(formgrader, LESSON, WRITTEN, {TEXT % who: points[who] for who in points})
    for command in ('./course grade', './course feedback'):
        in_checkout(command)
    in_checkout(f'.venv/bin/nbgrader release_feedback {LESSON}')
    return points


def test_points_and_comment_given_by_hand_reach_the_student(machine, pages, scored_by_hand):
    for student, total in zip(machine.students, ('3.5', '0.5'), strict=True):
        points, comment = scored_by_hand[student]
        said = AssignmentList(pages[student]).open_feedback(LESSON)
        assert f'Feedback for {student} · {LESSON} {total} of 4 points' in said
        assert f'Your written answer {points} of 2' in said
        assert comment in said


def test_no_page_but_the_instructors_may_be_shown_in_a_frame(machine, pages):
    allowed = {}
    for user, page in pages.items():
        reply = page.request.get(f'{machine.address}/user/{user}/api/status')
        allowed[user] = reply.headers['content-security-policy'].partition(';')[0]
    nowhere = dict.fromkeys(machine.students, "frame-ancestors 'none'")
    assert allowed == nowhere | {machine.instructor: "frame-ancestors 'self'"}
