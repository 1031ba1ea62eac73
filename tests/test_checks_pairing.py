"""Which θ1 a log pairs with which θ2, in many layouts."""

import pytest
from my_robot_basics.checks.values import pairing

UP, DOWN = (65.92, -74.04), (1.46, 74.04)
SOLUTIONS = [UP, DOWN]
BOTH = [*UP, *DOWN]


def by_turns(*pairs):
    return ' '.join(f'{angle:.2f}' for pair in pairs for angle in pair)


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
        [f'{UP[0]}\n{DOWN[1]}\n{UP[1]}\n{DOWN[0]}'],
        # one line for each angle pairs none of them, in any order
        [str(angle) for angle in (UP[0], DOWN[1], DOWN[0], UP[1])],
        # sorted, and a set: 1.46 and 65.92 between the others
        [' '.join(map(str, sorted(BOTH)))],
        [by_turns(sorted(BOTH)[:2]), by_turns(sorted(BOTH)[2:])],
        [f'{sorted(BOTH, reverse=True)}'],
        ['angles: {65.92, 74.04, 1.46, -74.04}'],
        # names pair each angle with the angle of its own branch
        ['up θ1=65.92', 'down θ2=74.04', 'up θ2=-74.04', 'down θ1=1.46'],
        ['up θ1=65.92, down θ2=74.04', 'down θ1=1.46, up θ2=-74.04'],
        ['θ1_up 65.92 θ2_down 74.04 θ1_down 1.46 θ2_up -74.04'],
        ['65.92° (θ1, up), 74.04° (θ2, down), 1.46° (θ1, down), -74.04° (θ2, up)'],
        ['solution 1: 65.92, solution 2: 74.04, solution 2: 1.46, solution 1: -74.04'],
        # pairs, and all of it once more in some order
        [by_turns(UP), by_turns(DOWN), by_turns((UP[0], DOWN[1]), (DOWN[0], UP[1]))],
        # joint by joint in two orders: no angle is paired with another one
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
    assert not pairing.are_mixed_up(SOLUTIONS, texts)


@pytest.mark.parametrize(
    'texts',
    [
        [by_turns((UP[0], DOWN[1]), (DOWN[0], UP[1]))],
        [by_turns((UP[0], DOWN[1])), by_turns((DOWN[0], UP[1]))],
        [by_turns((UP[0], DOWN[1])), 'at 1.44 m', by_turns((DOWN[0], UP[1]))] * 3,
        ['[[65.92 74.04]\n [1.46 -74.04]]'],
        ["{'up': (65.92, 74.04), 'down': (1.46, -74.04)}"],
        ['{65.92, 74.04} {1.46, -74.04}'],
        ['74.04 65.92; -74.04 1.46'],
        ['up: 1.46 and -74.04 or down: 65.92 and 74.04'],
        ['θ1 = 65.92°, θ2 = 74.04°', 'θ1 = 1.46°, θ2 = -74.04°'],
        # names pair each angle with the angle of the other branch
        ['up θ1=65.92', 'up θ2=74.04', 'down θ1=1.46', 'down θ2=-74.04'],
        ['up θ1=65.92', 'down θ1=1.46', 'up θ2=74.04', 'down θ2=-74.04'],
        ['θ1_up 65.92 θ2_up 74.04 θ1_down 1.46 θ2_down -74.04'],
    ],
)
def test_angles_paired_across_branches_are_mixed_up(texts):
    assert pairing.are_mixed_up(SOLUTIONS, texts)


def test_nearly_equal_angles_are_not_called_mixed_up():
    alike = [(30.0, 30.005), (30.0, -30.005)]
    assert not pairing.are_mixed_up(alike, [by_turns((30.0, -30.005), (30.0, 30.005))])


def test_sorted_angles_are_not_called_mixed_up():
    solutions = [(-150.0, -74.04), (-100.0, 74.04)]
    texts = ['-150.0 -100.0 -74.04 74.04', '74.04 -74.04 -100.0 -150.0']
    assert not pairing.are_mixed_up(solutions, texts)
    crossed = [(80.0, -74.04), (-10.0, 74.04)]
    assert not pairing.are_mixed_up(crossed, ['-74.04 -10.0 74.04 80.0'])
    assert pairing.are_mixed_up(crossed, ['-10.0 -74.04 80.0 74.04'])
