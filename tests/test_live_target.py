"""Sliders that publish a target point, and the arm that follows the topic."""

import math

import pytest
import rclpy
from geometry_msgs.msg import Point
from jupyter_client.manager import start_new_kernel
from my_robot_basics.live import drag_target, run, stop, wait_until
from my_robot_basics.live.pictures.target import TargetView
from my_robot_basics.two_link_kinematics import forward_kinematics
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook
from rclpy.node import Node

DRAG = """
from ipywidgets import FloatSlider
from ipywidgets.widgets.widget import _instances
from my_robot_basics.live import drag_target, run, stop, wait_until
from geometry_msgs.msg import Point
from rclpy.node import Node

heard = []
run(Node, 'solver').create_subscription(Point, '/target_point', heard.append, 10)
drag_target()
x, y = [w for w in _instances.values() if isinstance(w, FloatSlider)]
x.value = 0.5  # what the browser's message does
wait_until(lambda: heard and heard[-1].x == 0.5)
print(heard[-1], x.disabled)
stop()
print(x.disabled, y.disabled)
"""


@pytest.fixture
def view():
    return TargetView('/target_point', x=1.2, y=0.8, l1=1.0, l2=0.8)


def lines_of(view):
    view._bundle()
    return [line.get_xydata() for line in view._picture._figure.axes[0].lines]


def test_a_dragged_slider_publishes_a_target_and_stop_disables_the_sliders():
    notebook = new_notebook(cells=[new_code_cell(DRAG)])
    NotebookClient(notebook, timeout=60, kernel_name='python3').execute()
    texts = [output.text for output in notebook.cells[0].outputs if 'text' in output]
    assert ''.join(texts) == ('geometry_msgs.msg.Point(x=0.5, y=0.8, z=0.0) False\nTrue True\n')
    sliders, picture = [o for o in notebook.cells[0].outputs if 'data' in o][1:]
    assert 'application/vnd.jupyter.widget-view+json' in sliders.data
    assert sliders.data['text/plain'].startswith('Run this cell: two sliders')
    assert 'image/png' in picture.data
    assert picture.metadata['image/png']['alt'] == picture.data['text/plain']


def test_both_ik_branches_of_the_arm_end_at_the_target(view):
    view.receive(Point(x=-0.4, y=1.1, z=9.0))
    _, tip, _, dashed, target, *_ = lines_of(view)
    assert tip[-1] == pytest.approx([-0.4, 1.1])
    assert dashed[-1] == pytest.approx([-0.4, 1.1])
    assert target[0] == pytest.approx([-0.4, 1.1])
    assert forward_kinematics(*view._pose) == pytest.approx((-0.4, 1.1))


@pytest.mark.parametrize('target', [(2.0, 0.0), (0.0, 0.1), (math.nan, 0.0)])
def test_the_arm_stays_and_the_title_says_why_if_a_target_is_out_of_reach(view, target):
    view.receive(Point(x=1.2, y=0.8))
    before = view._pose
    view.receive(Point(x=target[0], y=target[1]))
    view._bundle()
    assert view._pose == before
    assert 'no pose' in view._picture._figure.axes[0].get_title()
    view.receive(Point(x=0.5, y=0.8))
    assert view._pose != before


def test_the_arm_follows_the_targets_of_any_publisher(monkeypatch):
    views = []
    receive = TargetView.receive

    def spy(self, message):
        receive(self, message)
        views.append((self, message))

    monkeypatch.setattr(TargetView, 'receive', spy)
    drag_target(0.9, -0.7, topic_name='/other_target')
    try:
        other = run(Node, 'somebody').create_publisher(Point, '/other_target', 10)
        wait_until(lambda: other.get_subscription_count() == 1)
        other.publish(Point(x=0.3, y=0.9))
        wait_until(lambda: views and views[-1][1].x == 0.3)
        first, last = views[0][1], views[-1][0]
        assert (first.x, first.y) == (0.9, -0.7)
        assert forward_kinematics(*last._pose) == pytest.approx((0.3, 0.9))
    finally:
        stop()
        rclpy.try_shutdown()


@pytest.mark.slow
def test_a_kernel_that_ends_with_open_sliders_prints_no_error(tmp_path):
    log = tmp_path / 'stderr'
    with log.open('w') as stderr:
        manager, client = start_new_kernel(kernel_name='python3', stderr=stderr)
        client.execute_interactive(
            'from my_robot_basics.live import drag_target; drag_target()',
            output_hook=lambda message: None,
            timeout=60,
        )
        client.stop_channels()
        manager.request_shutdown()
        assert manager.provisioner.process.wait(timeout=30) == 0
        manager.cleanup_resources()
    assert 'Error' not in log.read_text()
