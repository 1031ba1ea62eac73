"""Pictures of the arm."""

import io
import math
import re
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.transforms import Bbox
from my_robot_basics.drawing.arm import ArmPicture, describe
from my_robot_basics.live import show_arm
from my_robot_basics.live.pictures.follow import ArmView, what_is_wrong
from sensor_msgs.msg import JointState


def axes_of(picture):
    return picture._figure.axes[0]


def test_the_axes_are_in_metres_and_equal_and_hold_the_whole_ring():
    axes = axes_of(ArmPicture(l1=1.0, l2=0.8))
    assert axes.get_aspect() == 1
    assert '(m)' in axes.get_xlabel()
    assert '(m)' in axes.get_ylabel()
    ring = axes.patches[0]
    assert (ring.r, ring.r - ring.width) == pytest.approx((1.8, 0.2))
    assert axes.get_xlim()[0] < -1.8
    assert axes.get_ylim()[1] > 1.8


@pytest.mark.parametrize('pose', [(0, 0), (90, 0), (23.4, -67.8), (-90, 180), (1718.9, 2578.3)])
def test_links_labels_and_description_match_the_pose(pose):
    picture = ArmPicture(l1=1.0, l2=0.8)
    picture.move(*pose)
    lines = {line.get_label(): line.get_xydata() for line in axes_of(picture).lines}
    # an oracle of its own: a planar arm is a sum of complex numbers
    elbow = 1.0 * np.exp(1j * math.radians(pose[0]))
    tip = elbow + 0.8 * np.exp(1j * math.radians(sum(pose)))
    assert lines['link 1'][-1] == pytest.approx([elbow.real, elbow.imag])
    assert lines['end effector'][0] == pytest.approx([tip.real, tip.imag])
    words = [text.get_text() for text in axes_of(picture).texts]
    assert words == [f'θ1 = {pose[0]:.1f}°', f'θ2 = {pose[1]:.1f}°']
    told = [float(number) for number in re.findall(r'[xy] = (\S+) m', describe(*pose))]
    assert told == pytest.approx([tip.real, tip.imag], abs=6e-4)


@pytest.mark.parametrize('dashed', [None, (0, 90)])
def test_the_labels_cover_neither_links_nor_one_another(dashed):
    picture = ArmPicture(l1=1.0, l2=0.8)
    if dashed:
        picture.dashed(*dashed)
    axes, covered = axes_of(picture), []
    for pose in [*product(range(-180, 181, 45), repeat=2), (-79.6, 1.8), (1718.9, 2578.3)]:
        picture.move(*pose)
        renderer = picture._canvas.get_renderer()
        first, second = (words.get_window_extent(renderer) for words in axes.texts)
        if Bbox.intersection(first, second):
            covered.append((pose, 'θ2 on θ1'))
        for line in axes.lines:
            if line.get_linestyle() in ('-', '--') and len(line.get_xydata()):
                path = line.get_transform().transform_path(line.get_path())
                hidden = (box for box in (first, second) if path.intersects_bbox(box, False))
                covered += [(pose, line.get_label()) for _ in hidden]
    assert covered == []


def test_moving_leaves_nothing_of_the_former_pose():
    picture = ArmPicture()
    picture.move(10, 20)
    first = picture.png()
    for theta_deg in range(0, 360, 45):
        picture.move(theta_deg, -theta_deg)
    assert picture.png() != first
    picture.move(10, 20)
    assert np.array_equal(imread(io.BytesIO(picture.png())), imread(io.BytesIO(first)))


def test_a_second_pose_is_dashed_and_dots_are_drawn_at_their_coordinates(capsys):
    picture = ArmPicture(l1=1.0, l2=0.8)
    picture.dashed(0, 90)
    picture.dots([0.5, -0.5], [1.0, 1.0])
    *_, dots = axes_of(picture).lines
    [second] = [line for line in axes_of(picture).lines if line.get_linestyle() == '--']
    assert second.get_xydata() == pytest.approx(np.array([[0, 0], [1, 0], [1, 0.8]]))
    assert dots.get_xydata() == pytest.approx(np.array([[0.5, 1.0], [-0.5, 1.0]]))
    show_arm(0, 0, other=(0, 90), dots=([0.5], [1.0]))
    assert '1 dots; dashed: θ1 = 0.0°, θ2 = 90.0°' in capsys.readouterr().out


@pytest.mark.parametrize('pose', [(math.nan, 0.0), (0.0, math.inf)])
def test_a_pose_that_is_not_finite_is_refused(pose):
    with pytest.raises(ValueError, match=r'finite|NaN|nan|inf'):
        show_arm(*pose)


def test_show_arm_prints_the_pose_outside_a_notebook(capsys):
    show_arm(23.4, -67.8)
    assert 'θ1 = 23.4°' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('message', 'wrong'),
    [
        (JointState(name=['joint1', 'joint2'], position=[0.1, 0.2]), ''),
        (JointState(name=['joint2', 'gripper', 'joint1'], position=[0.1, 0.2, 0.3]), ''),
        (JointState(name=['joint1', 'joint2'], position=[0.1]), '2 names, but 1 positions'),
        (JointState(name=['joint1'], position=[0.1, 0.2]), 'no joint2 among the names'),
        (JointState(position=[0.1, 0.2]), 'no joint1 and no joint2'),
        (JointState(name=['joint1', 'joint2'], position=[0.1, math.nan]), 'joint2 is nan'),
    ],
)
def test_a_joint_state_without_a_pose_is_reported_with_the_reason(message, wrong):
    assert wrong in what_is_wrong(message)
    assert bool(what_is_wrong(message)) is bool(wrong)


def test_two_threads_may_draw_one_picture():
    view = ArmView('/poses', l1=1.0, l2=0.8)
    with ThreadPoolExecutor(2) as threads:
        view.receive(JointState(name=['joint1', 'joint2'], position=[0.5, -1.2]))
        pictures = list(threads.map(lambda _: view._bundle()['image/png'], range(30)))
    assert len(set(pictures)) == 1
