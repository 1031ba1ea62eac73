"""Lines of a log about IK: which hold angles, and which θ1 stands with which θ2."""

import pytest
from my_robot_basics.checks import answers

UP, DOWN = (65.92, -74.04), (1.46, 74.04)
SOLUTIONS = [UP, DOWN]


def by_turns(*pairs):
    return ' '.join(f'{angle:.2f}' for pair in pairs for angle in pair)


@pytest.mark.parametrize(
    ('text', 'numbers'),
    [
        ('up 1.5°, down -2', [1.5, -2.0]),
        ('−3.25 and +4e1', [-3.25, 40.0]),
        ('elbow = ±76.26°', [76.26, -76.26]),
        ('none', []),
    ],
)
def test_numbers_are_read_as_people_write_them(text, numbers):
    assert answers.numbers_of(text) == numbers


@pytest.mark.parametrize(
    'texts',
    [
        [by_turns(UP, DOWN)],
        [by_turns(DOWN, UP)],
        [by_turns(UP), by_turns(DOWN)],
        [f'{UP[1]} {UP[0]} {DOWN[1]} {DOWN[0]}'],
        [f'θ1: {UP[0]}, {DOWN[0]}', f'θ2: {UP[1]}, {DOWN[1]}'],
        [str(angle) for angle in (*UP, *DOWN)],
        [str(angle) for angle in (UP[0], DOWN[0], UP[1], DOWN[1])],
        # joint by joint in two orders: nothing tells what belongs together
        [f'{UP[0]} {DOWN[0]} {DOWN[1]} {UP[1]}'],
        ['no numbers', by_turns(UP, DOWN), '2 solutions'],
        # a distance or bearing that happens to be one of them
        [f'bearing {DOWN[1]}: {by_turns(UP, DOWN)}'],
        [f'bearing {DOWN[1]}, θ1 {UP[0]}', by_turns(UP), by_turns(DOWN)],
        # said again and again: the first one may be the end of the one before
        [by_turns(DOWN), by_turns(UP), by_turns(DOWN)],
        [],
    ],
)
def test_solutions_may_be_logged_in_many_ways(texts):
    assert not answers.are_mixed_up(SOLUTIONS, texts)


@pytest.mark.parametrize(
    'texts',
    [
        [by_turns((UP[0], DOWN[1]), (DOWN[0], UP[1]))],
        [by_turns((UP[0], DOWN[1])), by_turns((DOWN[0], UP[1]))],
        [by_turns((UP[0], DOWN[1])), 'at 1.44 m', by_turns((DOWN[0], UP[1]))] * 3,
        [str(angle) for angle in (UP[0], DOWN[1], DOWN[0], UP[1])],
    ],
)
def test_an_angle_with_the_other_branchs_angle_is_mixed_up(texts):
    assert answers.are_mixed_up(SOLUTIONS, texts)


def test_angles_that_are_alike_accuse_nobody():
    alike = [(30.0, 30.005), (30.0, -30.005)]
    assert not answers.are_mixed_up(alike, [by_turns((30.0, -30.005), (30.0, 30.005))])


@pytest.mark.parametrize(
    ('text', 'is_stretched'),
    [
        ('θ1=61.15°, θ2=0.00°', True),
        ('θ1=61.15°, θ2=-180.00°', True),
        ('[0.0, 61.15]', True),
        ('target at 3.000 m, bearing 61.15°', False),
        ('bearing 61.15°, 0 solutions', False),
        ('bearing 62.15°, θ2=0.00°', False),
    ],
)
def test_a_bearing_is_an_answer_only_with_the_elbow_of_a_stretched_arm(text, is_stretched):
    assert answers.has_stretched([61.15], text) is is_stretched


def test_a_form_that_other_lines_have_too_tells_nothing():
    texts = ['up 65.92 -74.04', 'distance 1.44', '1.44', '65.92']
    assert answers.forms_with([*UP], texts) == {'up # #'}
