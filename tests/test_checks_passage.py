"""What happens to messages that pass a node if the machine is busy, or if others publish."""

from itertools import count
from types import SimpleNamespace

import pytest
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.relays import pairs
from my_robot_basics.checks.relays import passage as passage_module
from my_robot_basics.checks.relays import pushed_out as pushed_out_module
from my_robot_basics.checks.relays.enough import fewest_in_a_row
from my_robot_basics.checks.relays.passage import MOST_LATE, Passage
from my_robot_basics.checks.relays.pushed_out import FEW, FLOOD, MOST, MOST_GRADED, PushedOut
from my_robot_basics.checks.relays.relay_faults import RelayFaults
from my_robot_basics.checks.relays.variety import VariedMessage
from my_robot_basics.feedback.errors import CheckFailed, Starved

SEC = 1_000_000_000
GAP_NS = SEC // 100


class Node:
    """Republishes each message at once, except the first of each pair that `loses` selects."""

    publishers = tuple

    def __init__(self, loses, apart_ns=GAP_NS):
        self.loses, self.received, self.numbers = loses, [], count()
        self.apart_ns = apart_ns

    def publish(self, message):
        number = next(self.numbers)
        if not (number % 2 == 0 and self.loses(number // 2)):
            self.received.append((message, self.apart_ns * number))


def passage_through(node, **options):
    watcher = SimpleNamespace(
        spin_for=lambda _: None, spin_until_free=lambda done, free_sec: done()
    )
    options = {'others_publish': False, **options}
    return Passage(watcher, node, publish=node.publish, what=lambda message: message, **options)


def loses_one_of_two(loses, **options):
    return passage_through(Node(loses, **options)).loses_one_of_two(
        VariedMessage(n, '') for n in count()
    )


@pytest.fixture(params=[False, True], ids=['free', 'busy'])
def is_busy(request, monkeypatch):
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: request.param)
    return request.param


@pytest.mark.usefixtures('is_busy')
@pytest.mark.parametrize('loses', [lambda pair: False, lambda pair: pair < 4])
def test_a_node_that_loses_only_its_first_pairs_passes(loses):
    assert not loses_one_of_two(loses)


@pytest.mark.usefixtures('is_busy')
@pytest.mark.parametrize(
    'loses',
    [lambda pair: True, lambda pair: pair % 15 != 5, lambda pair: pair not in (5, 12)],
)
def test_a_node_that_mostly_loses_one_message_of_two_is_detected(loses):
    assert loses_one_of_two(loses)


def test_a_busy_machine_may_lose_most_pairs_of_a_short_queue(is_busy):
    assert loses_one_of_two(lambda pair: pair < 6 or pair % 3) == (not is_busy)


@pytest.mark.usefixtures('is_busy')
def test_a_slow_timer_that_fires_between_two_messages_is_detected():
    """On a busy machine, its period ended inside every seventh pair, which gave it points."""
    assert loses_one_of_two(lambda pair: pair % 7 != 5, apart_ns=SEC // 2)


@pytest.mark.parametrize(
    ('received', 'began_sec', 'invents'),
    [(range(3, 8), 3, False), (range(6, 8), 0, True), (range(1), 0, True), (range(0), 0, True)],
    ids=['received late', 'received too late', 'received once', 'not received'],
)
def test_messages_of_other_publishers_received_late_do_not_count_as_invented(
    monkeypatch, received, began_sec, invents
):
    monkeypatch.setattr(passage_module.time, 'time_ns', lambda: began_sec * SEC)
    node = Node(lambda pair: False)
    passage = passage_through(node)
    node.received += [(f'of another {n}', SEC * n) for n in range(8)]
    assert not passage.loses_one_of_two(VariedMessage(n, '') for n in count())
    own = [(n, SEC * n) for n in range(4)]
    assert passage.invents(own + [(f'of another {n}', SEC * n) for n in received]) == invents


@pytest.mark.parametrize(
    ('row_sec', 'fewest'), [(0.0, 120), (2.4, 120), (2.5, 24), (3.9, 24), (4.0, 12), (60.0, 12)]
)
def test_a_slow_node_needs_fewer_messages_in_a_row(row_sec, fewest):
    assert fewest_in_a_row(SimpleNamespace(wall_sec=lambda: row_sec)) == fewest


@pytest.mark.parametrize(('is_timer', 'invents'), [(False, False), (True, True)])
def test_repeated_messages_from_a_queue_do_not_count_as_invented(monkeypatch, is_timer, invents):
    """A slow node passes on late what it was sent again and again; a timer goes on with it."""
    monkeypatch.setattr(passage_module.time, 'time_ns', lambda: 0)
    node = Node(lambda pair: False)
    passage = passage_through(node, earlier='first')
    node.received += [('first', SEC * n) for n in range(5)]
    assert not passage.loses_one_of_two(VariedMessage(n, '') for n in count())
    if is_timer:
        node.received += [('first', SEC * n) for n in range(5)]
        assert not passage.loses_after_a_pause(VariedMessage(n, '') for n in count(100))
    assert passage.invents([(n, SEC * n) for n in range(4)]) == invents


class SlowNode:
    """Has a queue of depth 1; `takes_sec` says how long each call of its callback takes."""

    publishers = tuple

    def __init__(self, takes_sec):
        self.takes_sec, self.numbers = takes_sec, count()
        self.received, self.queue, self.now_sec = [], None, 0.0

    def publish(self, message):
        self.queue = message, self.now_sec + self.takes_sec(next(self.numbers))

    def spin(self, done, free_sec):
        until_sec = self.now_sec + free_sec
        if self.queue is not None and self.queue[1] <= until_sec:
            (message, self.now_sec), self.queue = self.queue, None
            self.received.append((message, round(self.now_sec * SEC)))
        else:
            self.now_sec = until_sec
        return done()


@pytest.mark.parametrize(('slow_sec', 'lost'), [(0.01, 0), (0.3, 0), (5.0, 4)])
def test_a_slightly_late_message_is_not_pushed_out_of_a_queue_of_depth_1(slow_sec, lost):
    """Four slow calls on a busy machine were enough for "messages that are not republished"."""
    node = SlowNode(lambda number: slow_sec if number in (3, 9, 15, 21) else 0.001)
    watcher = SimpleNamespace(spin_for=lambda _: None, spin_until_free=node.spin)
    passage = Passage(
        watcher, node, publish=node.publish, what=lambda message: message, others_publish=False
    )
    faults = passage.carry(VariedMessage(n, '') for n in count())
    assert len(faults.lost) == lost
    assert faults.is_whole() == (lost == 0)


class NodeOfTwoPublishers(Node):
    """Loses some of the messages; instead, some of another publisher come out."""

    def __init__(self, loses, overtaking=FEW):
        super().__init__(loses)
        self.overtaking = overtaking

    def publish(self, message):
        number = next(self.numbers)
        if self.loses(number, message):
            self.received += [(f'{number}: {n}', 0) for n in range(self.overtaking)]
        else:
            self.received.append((message, 0))


def carried_beside_another_publisher(loses, overtaking=FEW, **options):
    passage = passage_through(NodeOfTwoPublishers(loses, overtaking), **options)
    return passage.carry(VariedMessage(n, '') for n in count())


@pytest.mark.parametrize('others_publish', [False, True])
def test_a_message_is_sent_again_if_another_publisher_may_have_pushed_it_out(
    is_busy, others_publish
):
    """Without this, stock Validate failed right nodes with a queue of depth 1 beside the arm."""
    faults = carried_beside_another_publisher(
        lambda number, message: number in (3, 9, 10, 21, 27), others_publish=others_publish
    )
    assert faults.is_whole() == (is_busy and others_publish)


@pytest.mark.usefixtures('is_busy')
def test_a_message_that_is_lost_again_when_resent_counts_as_lost():
    faults = carried_beside_another_publisher(
        lambda number, message: message % 10 == 3, others_publish=True
    )
    assert len(faults.lost) == 4


@pytest.mark.usefixtures('is_busy')
def test_many_losses_fail_even_beside_another_publisher():
    faults = carried_beside_another_publisher(
        lambda number, message: number % 3 != 0, others_publish=True
    )
    assert not faults.is_whole()


def test_a_message_that_was_sent_again_may_be_republished_twice(monkeypatch):
    """The first copy was only late."""
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)

    class LateTwice(NodeOfTwoPublishers):
        def publish(self, message):
            was_lost = self.received and ':' in str(self.received[-1][0])
            super().publish(message)
            if was_lost:
                self.received.append(self.received[-1])

    node = LateTwice(lambda number, message: number in (3, 9))
    passage = passage_through(node, others_publish=True)
    assert passage.carry(VariedMessage(n, '') for n in count()).is_whole()


@pytest.mark.parametrize(('lost', 'is_named'), [(2, False), (3, True), (4, True)])
def test_two_lost_messages_of_a_kind_name_no_cause(lost, is_named):
    """A node that drops every eleventh lost two negative ones by chance, on a busy machine."""
    fault, _ = RelayFaults(late=lost, lost=('with zeros',) * lost).fault()
    assert fault.endswith('those with zeros') == is_named


@pytest.fixture(params=[False, True], ids=['by hand', 'graded'])
def is_graded(request, monkeypatch):
    monkeypatch.setattr(pushed_out_module, 'is_in_test_room', lambda: request.param)
    return request.param


@pytest.mark.usefixtures('is_busy', 'is_graded')
@pytest.mark.parametrize('others_publish', [False, True])
def test_a_flood_of_others_excuses_no_message_that_is_lost_each_time(others_publish):
    """An answer that dropped negative numbers, and flooded the topic meanwhile, had all points."""
    faults = carried_beside_another_publisher(
        lambda number, message: message % 4 == 3, FLOOD, others_publish=others_publish
    )
    assert (len(faults.lost), faults.doubt) == (4, CheckFailed)


@pytest.mark.parametrize('overtaking', [FEW, FLOOD])
@pytest.mark.parametrize(
    ('every', 'is_right'), [(3, False), (10, False), (13, True), (60, True)], ids=str
)
def test_every_tenth_message_is_no_coincidence_where_points_are_given(
    monkeypatch, is_graded, overtaking, every, is_right
):
    """An answer that dropped each third, published others, and burned time had all points."""
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    # as after some seconds of a slow node or machine
    monkeypatch.setattr(pushed_out_module, 'fewest_in_a_row', lambda _: 12)
    faults = carried_beside_another_publisher(
        lambda number, message: number % every == min(5, every - 1),
        overtaking,
        others_publish=True,
    )
    assert faults.is_whole() == (is_right or not is_graded)
    assert faults.is_whole() or faults.doubt is Starved


@pytest.mark.parametrize(('lost', 'is_whole'), [(MOST_GRADED, True), (MOST_GRADED + 1, False)])
def test_a_few_losses_are_excused_where_points_are_given(monkeypatch, lost, is_whole):
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    monkeypatch.setattr(pushed_out_module, 'is_in_test_room', lambda: True)
    faults = carried_beside_another_publisher(
        lambda number, message: number % 30 == 5 and number < 30 * lost, others_publish=True
    )
    assert faults.is_whole() == is_whole
    assert lost < MOST


@pytest.mark.parametrize(
    ('lost', 'is_whole'), [(MOST + MOST_LATE - 1, True), (MOST + MOST_LATE, False)]
)
def test_more_losses_are_excused_by_hand_and_never_in_doubt(monkeypatch, lost, is_whole):
    """Nobody takes a second look there."""
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    faults = carried_beside_another_publisher(
        lambda number, message: number % 5 == 2 and number < 5 * lost, others_publish=True
    )
    assert (faults.is_whole(), faults.doubt) == (is_whole, CheckFailed)


@pytest.mark.parametrize('is_lost', [False, True])
def test_an_excused_loss_is_in_doubt_if_too_few_messages_came_out_in_time(
    monkeypatch, is_graded, is_lost
):
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    monkeypatch.setattr(passage_module, 'MOST_SEC', 0.0)
    faults = carried_beside_another_publisher(
        lambda number, message: is_lost and number == 1, others_publish=True
    )
    in_doubt = is_graded and is_lost
    assert (faults.is_whole(), faults.doubt) == (
        not in_doubt,
        Starved if in_doubt else CheckFailed,
    )


def test_no_more_messages_are_sent_once_too_many_losses_are_in_doubt(monkeypatch):
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    monkeypatch.setattr(pushed_out_module, 'is_in_test_room', lambda: True)
    node = NodeOfTwoPublishers(lambda number, message: number % 30 == 5)
    faults = passage_through(node, others_publish=True).carry(
        VariedMessage(n, '') for n in count()
    )
    assert faults.doubt is Starved
    assert next(node.numbers) == 30 * MOST_GRADED + 5 + 1


def test_losses_that_nothing_excuses_are_in_no_doubt(monkeypatch):
    monkeypatch.setattr(pairs.Stopwatch, 'is_busy', lambda _: True)
    monkeypatch.setattr(pushed_out_module, 'is_in_test_room', lambda: True)
    node = NodeOfTwoPublishers(lambda number, message: number == 5 or number > 20)

    def messages():
        for number in count():
            node.overtaking = FEW if number < 10 else 0
            yield VariedMessage(number, '')

    faults = passage_through(node, others_publish=True).carry(messages())
    assert (len(faults.lost), faults.doubt) == (4, CheckFailed)


@pytest.mark.parametrize(
    ('overtaking', 'others_publish', 'is_busy', 'may_be'),
    [
        (FEW, True, True, True),
        (FEW - 1, True, True, False),
        (FEW, False, True, False),
        (FEW, True, False, False),
        (FLOOD, True, False, True),
        (FLOOD, False, True, False),
    ],
    ids=['overtaken', 'by fewer', 'by nobody else', 'on an idle machine', 'flooded', 'by itself'],
)
def test_a_message_may_be_pushed_out_by_several_others_on_a_busy_machine(
    overtaking, others_publish, is_busy, may_be
):
    watch = SimpleNamespace(is_busy=lambda: is_busy)
    assert PushedOut(others_publish).may_be(overtaking, watch) is may_be


@pytest.mark.parametrize(
    ('on_source', 'others_publish'), [({'/relay'}, False), ({'/relay', '/arm'}, True)]
)
def test_nodes_that_publish_only_on_the_source_count_as_other_publishers(
    on_source, others_publish
):
    source = SimpleNamespace(publishers=lambda: on_source)
    out = SimpleNamespace(publishers=lambda: {'/relay'})
    assert Recorder.has_other_publishers(source, out) is others_publish
