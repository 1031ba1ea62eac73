"""Sliders that move the arm."""

import base64
import io

import numpy as np
import pytest
from matplotlib.image import imread
from my_robot_basics.live import move_arm
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

SHOW = 'from my_robot_basics.live import move_arm\nmove_arm(0.0, 90.0)'
DRAG = f"""
{SHOW}

from ipywidgets import FloatSlider
from ipywidgets.widgets.widget import _instances

theta1, theta2 = [w for w in _instances.values() if isinstance(w, FloatSlider)][-2:]
theta1.value = -20.0  # what the browser's message does
"""


@pytest.fixture(scope='module')
def cells():
    """A cell with sliders, and one whose slider was dragged; executed."""
    notebook = new_notebook(cells=[new_code_cell(SHOW), new_code_cell(DRAG)])
    NotebookClient(notebook, timeout=60, kernel_name='python3').execute()
    return notebook.cells


def pixels(output):
    return imread(io.BytesIO(base64.b64decode(output['data']['image/png'])))


def test_sliders_are_stored_with_a_text_for_pages_without_a_kernel(cells):
    sliders, _ = cells[0].outputs
    assert 'application/vnd.jupyter.widget-view+json' in sliders.data
    assert sliders.data['text/plain'].startswith('Run this cell: two sliders')


def test_a_moved_slider_moves_the_arm(cells):
    before, after = (cell.outputs[1] for cell in cells)
    assert 'θ1 = 0.0°, θ2 = 90.0°' in before.data['text/plain']
    assert 'θ1 = -20.0°, θ2 = 90.0°' in after.data['text/plain']
    assert not np.array_equal(pixels(before), pixels(after))


def test_the_alt_text_of_a_picture_is_its_description(cells):
    for picture in (cell.outputs[1] for cell in cells):
        assert picture.metadata['image/png']['alt'] == picture.data['text/plain']


def test_move_arm_prints_the_pose_outside_a_notebook(capsys):
    move_arm(0.0, 90.0)
    assert 'x = 1.000 m, y = 0.800 m' in capsys.readouterr().out
