"""Which QoS offers match which requests: the picture agrees with rclpy."""

from io import BytesIO
from itertools import product

import matplotlib.image
import pytest
from my_robot_basics.live import show_offers
from my_robot_basics.live.output import notebook
from my_robot_basics.live.pictures import qos_offers
from rclpy.qos import (
    DurabilityPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

ENUMS = {'reliability': ReliabilityPolicy, 'durability': DurabilityPolicy}
PAIRS = [
    (policy, *pair)
    for policy, values in qos_offers.POLICIES.items()
    for pair in product(values, repeat=2)
]


@pytest.mark.parametrize(('policy', 'offered', 'requested'), PAIRS)
def test_a_qos_pair_matches_if_rclpy_finds_no_error(policy, offered, requested):
    ends = [
        QoSProfile(depth=1, **{policy: ENUMS[policy][value]}) for value in (offered, requested)
    ]
    compatible = qos_check_compatible(*ends)[0] != QoSCompatibility.ERROR
    assert qos_offers.matches(qos_offers.POLICIES[policy], offered, requested) == compatible


def test_every_qos_pair_is_listed_in_words(monkeypatch):
    shown = []
    monkeypatch.setattr(notebook.Display, 'show', lambda self, bundle: shown.append(bundle))
    show_offers()
    [bundle] = shown
    assert bundle['image/png'].startswith(b'\x89PNG')
    for _, offered, requested in PAIRS:
        assert f'{offered} → {requested} ' in bundle['text/plain']
    assert bundle['text/plain'].count(' no') == 2


def test_the_picture_of_qos_offers_fits_a_phone_and_is_opaque():
    picture = matplotlib.image.imread(BytesIO(qos_offers.draw()))
    assert picture.shape[1] <= 400
    # opaque, and white at its border: as readable on a dark page
    assert (picture[[0, -1], :, :] == 1).all()
