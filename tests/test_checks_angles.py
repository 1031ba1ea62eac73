"""Angles in a log: which numbers count as angles, and the advice for missing ones."""

import math

import pytest
from my_robot_basics.checks.values import angles

WANTED = (23.4, -67.8, -35.92, 67.8)


@pytest.mark.parametrize(
    ('number', 'is_near'),
    [(23.41, True), (23.4 - 360.0, True), (383.4, True), (23.42, False), (-23.4, False)],
)
def test_angles_are_compared_up_to_whole_turns(number, is_near):
    assert angles.is_near(23.4, number) is is_near


@pytest.mark.parametrize(
    ('numbers', 'advice'),
    [
        ((), 'print(…) does not reach the log'),
        ([round(angle) for angle in WANTED], 'two decimals or more'),
        ([round(angle, 1) for angle in WANTED], 'two decimals or more'),
        ([int(angle) for angle in WANTED], 'two decimals or more'),
        ([angle + 0.05 for angle in WANTED], 'close, and not right'),
        ([math.radians(angle) for angle in WANTED], 'these are radians'),
        ([round(math.radians(angle), 2) for angle in WANTED], 'these are radians'),
        ([round(math.degrees(angle), 2) for angle in WANTED], 'degrees converted once more'),
        (WANTED[:2], 'both angles of both branches: one branch is not there'),
        ([WANTED[0], WANTED[2]], 'θ2 is missing or wrong in both'),
        (WANTED[:3], '1 of 4 angles missing or wrong'),
        # what atan(y / x) makes of the left half plane, and of a wrong sign of y
        ([WANTED[0] - 180, WANTED[1], WANTED[2] + 180, WANTED[3]], 'half a turn off: atan2(y, x)'),
        # what π minus the angle at the elbow makes of θ2
        ([WANTED[0], 180 - WANTED[1], WANTED[2], 180 - WANTED[3]], 'θ2 is half a turn off'),
        ([-23.4, -67.8, 35.92, 67.8], 'all angles are mirrored, so look at the sign of y'),
        ([-angle / 2 for angle in WANTED], 'compare with what inverse_kinematics(x, y) returns'),
        # of the target (y, x), and of its other branch
        ([90.0 - WANTED[2], WANTED[1], 90.0 - WANTED[0], WANTED[3]], 'x and y are swapped'),
        # one of them by chance
        ([90.0 - WANTED[2], WANTED[1], WANTED[3]], 'θ1 is missing or wrong in both'),
        # those of the target, and the number of its branches
        ((1.2, 0.8, 2), 'compare with what inverse_kinematics(x, y) returns'),
    ],
)
def test_advice_for_missing_angles_fits_the_logged_numbers(numbers, advice):
    assert angles.missing(WANTED, numbers)
    found = angles.what_to_try(WANTED, numbers)
    assert advice in found
    assert not any(f'{abs(angle):g}' in found for angle in WANTED)


def test_four_digits_in_all_are_too_few_decimals_for_large_angles_only():
    wanted = -72.65, -111.25, -165.46, 111.25
    found = angles.what_to_try(wanted, [float(f'{angle:.4g}') for angle in wanted])
    assert found == angles.DECIMALS
