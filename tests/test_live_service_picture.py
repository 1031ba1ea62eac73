"""Two clients and one server: a picture, and its description in words."""

from io import BytesIO

import matplotlib.image
from my_robot_basics.live import show_service
from my_robot_basics.live.output import notebook
from my_robot_basics.live.pictures import service_picture


def test_each_client_gets_its_own_response_after_its_request(monkeypatch):
    shown = []
    monkeypatch.setattr(notebook.Display, 'show', lambda self, bundle: shown.append(bundle))
    show_service()
    [bundle] = shown
    assert bundle['image/png'].startswith(b'\x89PNG')
    steps = bundle['text/plain'].split(': ')[1].split(' → ')
    for client in 'left', 'right':
        asked = steps.index(f'{client} sends a request')
        worked = steps.index(f'the callback for {client} runs')
        assert asked < worked < steps.index(f'the response goes to {client} alone')


def test_the_picture_of_a_service_fits_a_phone_and_is_opaque():
    picture = matplotlib.image.imread(BytesIO(service_picture.draw()))
    assert picture.shape[1] <= 400
    # opaque, and white at its border: as readable on a dark page
    assert (picture[[0, -1], :, :] == 1).all()
