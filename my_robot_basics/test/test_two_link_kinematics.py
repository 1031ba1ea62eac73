"""FK is compared with complex numbers, and IK with the intersections of two circles."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from my_robot_basics.two_link_kinematics import forward_kinematics, inverse_kinematics

angles = st.floats(-180, 180, exclude_min=True)
lengths = st.floats(0.05, 20)
NAN, INF = math.nan, math.inf


def end_effector(theta1_deg, theta2_deg, l1, l2):
    """Each link is a complex number; turning is multiplying."""
    turn1, turn2 = (cmath.rect(1, math.radians(angle)) for angle in (theta1_deg, theta2_deg))
    return turn1 * (l1 + l2 * turn2)


def elbow(theta1_deg, l1):
    return cmath.rect(l1, math.radians(theta1_deg))


def left_of_target(theta1_deg, l1, target):
    """How far the elbow lies to the left of the line from the base to the target (m)."""
    return (elbow(theta1_deg, l1) * target.conjugate()).imag / abs(target)


@given(st.floats(-1000, 1000), st.floats(-1000, 1000), lengths, lengths)
@example(23.4, -67.8, 1.0, 0.8)
def test_fk_agrees_with_complex_numbers(theta1_deg, theta2_deg, l1, l2):
    x, y = forward_kinematics(theta1_deg, theta2_deg, l1, l2)
    assert type(x) is type(y) is float
    assert complex(x, y) == pytest.approx(
        end_effector(theta1_deg, theta2_deg, l1, l2), abs=1e-11 * (l1 + l2)
    )


@pytest.mark.parametrize(
    ('pose_deg', 'position'),
    [
        ((23.4, -67.8), (1.489333, -0.162583)),
        ((0, 0), (1.8, 0)),
        ((90, 0), (0, 1.8)),
        ((0, 90), (1, 0.8)),
        ((0, 180), (0.2, 0)),
        ((-90, 90), (0.8, -1)),
    ],
)
def test_fk_gives_known_positions(pose_deg, position):
    assert forward_kinematics(*pose_deg) == pytest.approx(position, abs=1e-6)


@given(angles, angles, lengths, lengths)
@example(23.4, -67.8, 1.0, 0.8)
@example(10.0, 0.0, 1.0, 0.8)  # stretched
@example(10.0, 180.0, 1.0, 0.8)  # folded
@example(10.0, 180.0, 1.0, 1.0)  # folded onto the base
@example(10.0, 179.9999999, 1.0, 1.0)
@example(-179.9, 1e-9, 0.8, 1.0)
def test_both_solutions_reach_the_target_and_lie_on_their_side(theta1_deg, theta2_deg, l1, l2):
    target = end_effector(theta1_deg, theta2_deg, l1, l2)
    solutions = inverse_kinematics(target.real, target.imag, l1, l2)
    assert list(solutions) == ['elbow_up', 'elbow_down']
    for theta1, theta2 in solutions.values():
        assert type(theta1) is type(theta2) is float
        assert -180 < theta1 <= 180
        assert -180 < theta2 <= 180
        assert end_effector(theta1, theta2, l1, l2) == pytest.approx(target, abs=2e-9)
    assert solutions['elbow_down'][1] >= 0
    assert solutions['elbow_up'][1] <= 0 or solutions['elbow_up'][1] == 180
    if abs(target) > 1e-3:
        assert left_of_target(solutions['elbow_up'][0], l1, target) >= -1e-9
        assert left_of_target(solutions['elbow_down'][0], l1, target) <= 1e-9


@given(angles, st.floats(1, 179), st.sampled_from([-1, 1]), lengths, lengths)
def test_ik_finds_the_pose_again_in_the_branch_of_the_sign_of_theta2(
    theta1_deg, bend_deg, sign, l1, l2
):
    target = end_effector(theta1_deg, sign * bend_deg, l1, l2)
    branch = 'elbow_up' if sign < 0 else 'elbow_down'
    theta1, theta2 = inverse_kinematics(target.real, target.imag, l1, l2)[branch]
    assert math.remainder(theta1 - theta1_deg, 360) == pytest.approx(0, abs=1e-6)
    assert theta2 == pytest.approx(sign * bend_deg, abs=1e-6)


@given(st.floats(0.001, 0.999), angles, lengths, lengths)
def test_elbows_are_where_the_two_circles_meet(share, bearing_deg, l1, l2):
    """The elbow is l1 from the base and l2 from the target: two points, found without angles."""
    r = abs(l1 - l2) + share * 2 * min(l1, l2)
    direction = cmath.rect(1, math.radians(bearing_deg))
    along = (r * r + l1 * l1 - l2 * l2) / (2 * r)
    across = math.sqrt(max(0.0, l1 * l1 - along * along))
    target = r * direction
    solutions = inverse_kinematics(target.real, target.imag, l1, l2)
    tolerance = 1e-5 * (l1 + l2)  # the oracle cancels digits where a link is much the longer one
    up, down = (elbow(solutions[branch][0], l1) for branch in ('elbow_up', 'elbow_down'))
    assert up == pytest.approx(direction * complex(along, across), abs=tolerance)
    assert down == pytest.approx(direction * complex(along, -across), abs=tolerance)


@pytest.mark.parametrize(
    ('target', 'links', 'pose_deg'),
    [
        ((1.8, 0), (1.0, 0.8), (0, 0)),
        ((0, -1.8), (1.0, 0.8), (-90, 0)),
        ((-1.8, 0), (1.0, 0.8), (180, 0)),
        ((-1.8, -0.0), (1.0, 0.8), (180, 0)),
        ((1, 0), (3, 2), (0, 180)),
        ((0, 1), (3, 2), (90, 180)),
        ((1, 0), (2, 3), (180, 180)),
        ((0, 0), (1, 1), (0, 180)),
    ],
)
def test_a_singular_target_has_one_pose(target, links, pose_deg):
    solutions = inverse_kinematics(*target, *links)
    for theta1, theta2 in solutions.values():
        assert (theta1, theta2) == pytest.approx(pose_deg, abs=1e-6)
        assert '-0.0' not in (str(theta1), str(theta2))


@pytest.mark.parametrize('direction', [1, -1, 1j, cmath.rect(1, 2.5)])
@pytest.mark.parametrize(
    ('links', 'distance', 'reachable'),
    [
        ((3, 2), 5, True),
        ((3, 2), 5 + 0.9e-9, True),
        ((3, 2), 5 + 1.2e-9, False),
        ((3, 2), 1, True),
        ((3, 2), 1 - 0.9e-9, True),
        ((3, 2), 1 - 1.2e-9, False),
        ((2, 3), 1 - 0.9e-9, True),
        ((2, 3), 1 - 1.2e-9, False),
        ((1, 1), 0, True),
        ((1, 1), 1e-300, True),
        ((1, 1.1), 0, False),
    ],
)
def test_a_target_up_to_a_nanometre_outside_the_borders_is_reachable(
    direction, links, distance, reachable
):
    target = distance * direction
    if not reachable:
        with pytest.raises(ValueError, match=r'too (far|near)'):
            inverse_kinematics(target.real, target.imag, *links)
        return
    for pose in inverse_kinematics(target.real, target.imag, *links).values():
        assert end_effector(*pose, *links) == pytest.approx(target, abs=2e-9)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ((3, 4), r'5 m from the base, too far: the arm reaches 1.8 m .* nearer target'),
        ((0.1, 0), r'0.1 m from the base, too near: .* closer than 0.2 m .* farther target'),
        ((NAN, 0), 'x must be finite, got nan'),
        ((0, -INF), 'y must be finite, got -inf'),
        ((1, 0, INF, 1), 'l1 must be finite'),
        ((1, 0, 1, 0), 'l2 must be a length above 0 m, got 0'),
        ((1, 0, -1, 1), 'l1 must be a length above 0 m, got -1'),
        (([1, 2, 0], [0, 0, 0]), r'2 of 3 targets are out of reach; the first is 2 m .* too far'),
        (([[1], [0.1]], [0, 0]), r'2 of 4 targets are out of reach; the first is 0.1 m .* near'),
        (([1, NAN], 0), 'x must be finite'),
    ],
)
def test_ik_refuses_bad_targets_and_link_lengths(arguments, message):
    with pytest.raises(ValueError, match=message):
        inverse_kinematics(*arguments)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ((NAN, 0), 'theta1_deg must be finite, got nan'),
        ((0, INF), 'theta2_deg must be finite, got inf'),
        ((0, 0, NAN, 1), 'l1 must be finite'),
        ((0, 0, 1, 0), 'l2 must be a length above 0 m'),
    ],
)
def test_fk_refuses_bad_angles_and_link_lengths(arguments, message):
    with pytest.raises(ValueError, match=message):
        forward_kinematics(*arguments)


def test_arrays_give_the_same_results_as_their_elements():
    theta1_deg, theta2_deg = (
        np.array([[-80.0], [0.0], [45.0]]),
        np.array([-120.0, -1.0, 5.0, 90.0]),
    )
    x, y = forward_kinematics(theta1_deg, theta2_deg)
    assert x.shape == y.shape == (3, 4)
    solutions = inverse_kinematics(x, y)
    for row, column in np.ndindex(3, 4):
        number = forward_kinematics(theta1_deg[row, 0], theta2_deg[column])
        assert (x[row, column], y[row, column]) == number
        for branch, pose in inverse_kinematics(*number).items():
            assert tuple(angle[row, column] for angle in solutions[branch]) == pose


def test_numpy_numbers_give_plain_floats():
    numbers = [*forward_kinematics(np.float64(20), np.int64(30))]
    numbers += [a for pose in inverse_kinematics(np.float32(1), np.int8(1)).values() for a in pose]
    assert {type(number) for number in numbers} == {float}
