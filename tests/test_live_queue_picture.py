"""The way of a message through two queues: a picture, and its description in words."""

from io import BytesIO

import matplotlib.image
from my_robot_basics.live import show_queues
from my_robot_basics.live.output import notebook
from my_robot_basics.live.pictures import queue_picture


def test_the_way_of_a_message_through_the_queues_is_described_in_order(monkeypatch):
    shown = []
    monkeypatch.setattr(notebook.Display, 'show', lambda self, bundle: shown.append(bundle))
    show_queues()
    [bundle] = shown
    assert bundle['image/png'].startswith(b'\x89PNG')
    way = bundle['text/plain'].split(': ')[1].split(' → ')
    assert way[0] == 'publisher'
    assert way.index("the publisher's queue") < way.index("the subscription's queue")
    assert way[-2:] == ['the executor takes it', 'callback']


def test_the_picture_of_the_queues_fits_a_phone_and_is_opaque():
    picture = matplotlib.image.imread(BytesIO(queue_picture.draw()))
    assert picture.shape[1] <= 400
    # opaque, and white at its border: as readable on a dark page
    assert (picture[[0, -1], :, :] == 1).all()
