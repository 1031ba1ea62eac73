"""The way of a message through two queues: a picture, and what it says in words."""

from io import BytesIO

import matplotlib.image
from my_robot_basics.live import notebook, queue_picture, show_queues


def test_the_way_is_told_in_its_order(monkeypatch):
    shown = []
    monkeypatch.setattr(notebook.Display, 'show', lambda self, bundle: shown.append(bundle))
    show_queues()
    [bundle] = shown
    assert bundle['image/png'].startswith(b'\x89PNG')
    way = bundle['text/plain'].split(': ')[1].split(' → ')
    assert way[0] == 'publisher'
    assert way.index("the publisher's queue") < way.index("the subscription's queue")
    assert way[-2:] == ['the executor takes it', 'callback']


def test_it_needs_no_more_than_the_width_of_a_phone():
    picture = matplotlib.image.imread(BytesIO(queue_picture.draw()))
    assert picture.shape[1] <= 400
    # opaque, and white at its border: as readable on a dark page
    assert (picture[[0, -1], :, :] == 1).all()
