"""Which branch of IK a pose belongs to, and its picture."""

import random

import pytest
from my_robot_basics.live import show_branches
from my_robot_basics.live.pictures import branches
from my_robot_basics.live.pictures.branches import branch_of


@pytest.mark.parametrize(
    ('pose', 'branch'),
    [
        ((23.4, -67.8), 'elbow_up'),
        ((23.4, 67.8), 'elbow_down'),
        ((170.0, -20.0), 'elbow_up'),
        ((-170.0, 20.0), 'elbow_down'),
        ((400.0, 30.0), 'elbow_down'),
        ((45.0, 0.0), 'elbow_up'),
    ],
)
def test_branch_of_returns_the_ik_branch_of_a_pose(pose, branch):
    assert branch_of(*pose) == branch


def test_the_sign_of_theta2_decides_the_branch():
    poses = random.Random(1)
    for _ in range(500):
        theta1_deg, theta2_deg = poses.uniform(-180, 180), poses.uniform(-179, 179)
        expected = 'elbow_up' if theta2_deg < 0 else 'elbow_down'
        assert branch_of(theta1_deg, theta2_deg) == expected


def test_a_pose_in_neither_branch_raises_an_error(monkeypatch):
    monkeypatch.setattr(branches, 'inverse_kinematics', lambda *_: {'elbow_up': (1.0, 2.0)})
    with pytest.raises(ValueError, match=r'θ1 = 10°, θ2 = 20° in neither branch'):
        branch_of(10, 20)


def test_the_picture_holds_each_pose_with_its_branch(monkeypatch, capsys):
    figures = []
    monkeypatch.setattr(branches, 'png', figures.append)
    show_branches([(10.0, 20.0), (10.0, -20.0), (30.0, 40.0)])
    angles, places = figures[0].axes
    drawn = {line.get_label(): line.get_xydata().tolist() for line in angles.lines}
    assert drawn['elbow_up (1)'] == [[10.0, -20.0]]
    assert drawn['elbow_down (2)'] == [[10.0, 20.0], [30.0, 40.0]]
    assert '(degrees)' in angles.get_ylabel()
    assert '(m)' in places.get_xlabel()
    assert '1 in elbow_up and 2 in elbow_down' in capsys.readouterr().out
