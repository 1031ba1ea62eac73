"""A parameter that sets a node's rate: every honest way passes, and each mistake is named."""

import math

import pytest
from my_robot_basics.checks import CheckFailed, node_parameters, rate_parameter, topic
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.nodes import parameters
from my_robot_basics.checks.nodes.parameter_refusals import expect_all_refused, fail_refused
from my_robot_basics.checks.nodes.parameters import NodeParameters
from my_robot_basics.checks.nodes.rate_parameters import RateParameter
from my_robot_basics.checks.recordings import older_timers, rate_failure
from my_robot_basics.checks.topics import sampling
from my_robot_basics.feedback.errors import fail
from nodes.running import imported
from rcl_interfaces.msg import ParameterValue, SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.client import Client
from rclpy.task import Future

pytestmark = pytest.mark.starts
adjustable = imported('adjustable')
TOPIC = '/kinematics/joint_states'


def look_at_the_rate():
    rate = rate_parameter('/adjustable_publisher', 'rate_hz', topic_name=TOPIC)
    rate.expect_default(5.0)
    rate.expect_follows(10.0, 2.5)
    rate.expect_follows(4.0, beside_another=True)


def look_at_refusals():
    rate = rate_parameter('/adjustable_publisher', 'rate_hz', topic_name=TOPIC)
    rate.expect_takes(1.0, 50.0, 10.0)
    rate.expect_refuses(60.0, 0.0, 0.5, math.nan)


HONEST = [
    adjustable.Adjustable,
    adjustable.CancelsTheTimer,
    adjustable.SetsThePeriod,
    adjustable.ChangesAfterwards,
    adjustable.LimitsInTheDescriptor,
    adjustable.ReadsInEachTick,
    adjustable.SleepsInAThread,
    adjustable.TypesItself,
]


@pytest.mark.parametrize('NodeClass', HONEST)
def test_an_honest_way_passes(run, NodeClass):
    run(NodeClass)
    look_at_the_rate()
    look_at_refusals()


@pytest.mark.parametrize('NodeClass', [adjustable.ReadsInEachTick, adjustable.SleepsInAThread])
def test_an_honest_way_passes_at_each_rate_that_a_check_may_set(run, NodeClass):
    run(NodeClass)
    # 20 Hz: a node that looks at the clock every 10 ms needs steps that divide 10 ms
    rate = rate_parameter('/adjustable_publisher', 'rate_hz', topic_name=TOPIC)
    rate.expect_follows(12.5, 25.0, 4.0, 20.0)


def test_a_wall_recording_waits_for_a_node_that_remembers_simulated_time(run, monkeypatch):
    def drive_in_vain(driven, **_):
        for _ in range(60):
            driven.tick(100_000_000)
        return Inconclusive(sampling.UNEVEN)

    monkeypatch.setattr(sampling, '_record_in_steps', drive_in_vain)
    run(adjustable.ReadsInEachTick)
    recording = topic(TOPIC).record()
    assert (recording.clock, len(recording.messages) > 10) == ('wall', True)


OF_THE_RATE = [
    (adjustable.ReadsOnce, 'expected 10 Hz after rate_hz went from 5 to 10, saw 5 Hz as before: '
     'a timer keeps its period'),
    (adjustable.KeepsTheOldTimer, r'saw 1\d[.\d]* Hz, which is both together: call self.destroy_'),
    (adjustable.OneBehind, 'saw 5 Hz, the value before: while add_on_set_parameters_callback '
     'decides, get_parameter still returns the old value'),
    (adjustable.Integer, 'a parameter has the type of its default value: declare it with 5.0'),
    (adjustable.ChangesByTheFirst, 'expected 4 Hz after use_sim_time and rate_hz were set in one '
     'step, saw 2.5 Hz as before: your callback gets a list of all'),
    (adjustable.AnotherDefault, 'expected rate_hz = 5.0, saw 1.0: declare it with its default'),
]  # fmt: skip
OF_REFUSALS = [
    (adjustable.SetsThoughRefusing, 'change the timer only if none is refused'),
    (adjustable.GivesNoReason, 'expected a reason why rate_hz = 60 is refused, saw none: tell'),
    (adjustable.TakesAll, 'expected rate_hz = 60 to be refused, saw it was accepted: return Set'),
    (
        adjustable.Corrects,
        r'saw it was accepted, and rate_hz is [\d.]+ in the end: do not correct the value',
    ),
    (adjustable.JudgesTheFirst, 'expected use_sim_time and rate_hz = 60, set in one step, to be'),
    (
        adjustable.SaysYesTooSoon,
        'it was accepted: your callback gets a list of all that is set in',
    ),
    (adjustable.KeepsTheLastWord, 'expected rate_hz = 60 and use_sim_time, set in one step, to'),
    (adjustable.RefusesTheLimits, 'the limits themselves are allowed'),
    (adjustable.DividesFirst, 'ZeroDivisionError'),
    (
        adjustable.LetsNaNThrough,
        'expected rate_hz = nan to be refused, saw it was accepted: NaN is',
    ),
]
OF_BOTH = [
    (adjustable.NotDeclared, "expected the parameter rate_hz of /adjustable_publisher, saw rate: "
     'declare it in the constructor'),
    (adjustable.ReturnsNothing, 'expected a SetParametersResult from your callback, saw some'),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(('NodeClass', 'words'), OF_THE_RATE)
def test_a_mistake_with_the_rate_fails_only_the_check_of_the_rate(run, NodeClass, words):
    run(NodeClass)
    with pytest.raises(CheckFailed, match=words):
        look_at_the_rate()
    look_at_refusals()


@pytest.mark.slow
@pytest.mark.parametrize(('NodeClass', 'words'), OF_REFUSALS)
def test_a_mistake_with_refusals_fails_only_the_check_of_refusals(run, NodeClass, words):
    run(NodeClass)
    look_at_the_rate()
    with pytest.raises(CheckFailed, match=words):
        look_at_refusals()


class OldTimers:
    """The parameters of a node that ends no timer, and may make one of a refused value, too."""

    def __init__(self, monkeypatch, *, of_any):
        self.timers_hz, self.of_any, self.measured = [5.0, 1.0, 50.0, 10.0], of_any, 0
        monkeypatch.setattr(RateParameter, '_measure', lambda *_: self.measure())

    def measure(self):
        self.measured += 1
        return sum(self.timers_hz), CheckFailed

    def get(self, name):
        return 10.0

    get_number = get

    def set(self, name, *values):
        results = []
        for value in values:
            is_taken = name != 'rate_hz' or 1.0 <= value <= 50.0
            results.append(SetParametersResult(successful=is_taken, reason='no' * (not is_taken)))
            if name == 'rate_hz' and value > 0.0 and (is_taken or self.of_any):
                self.timers_hz.append(value)
        return results

    def set_beside_another(self, name, value, *, is_first=False):
        return self.set(name, value)[0]


def test_a_rate_that_becomes_a_text_after_a_refusal_fails(monkeypatch):
    told = iter([5.0, 'a text'])
    refused = SetParametersResult(successful=False, reason='no')
    monkeypatch.setattr(NodeParameters, 'get', lambda self, name: next(told))
    monkeypatch.setattr(
        NodeParameters, 'set', lambda self, name, *values: [refused for _ in values]
    )
    with pytest.raises(CheckFailed, match="expected rate_hz to be a number, saw 'a text'"):
        expect_all_refused(NodeParameters('/node'), 'rate_hz', 5.0, [60.0])


def test_timers_that_keep_running_do_not_fail_the_check_of_refusals(monkeypatch):
    timers = OldTimers(monkeypatch, of_any=False)
    RateParameter(timers, 'rate_hz', TOPIC).expect_refuses(0.0, -3.0, 0.5, 51.0, 70.0)
    assert timers.measured == 2


@pytest.mark.parametrize('rates_hz', [(0.5, 60.0), (0.0, -3.0, 0.5, 51.0)])
def test_a_timer_of_a_refused_value_fails_even_beside_older_timers(monkeypatch, rates_hz):
    timers = OldTimers(monkeypatch, of_any=True)
    with pytest.raises(CheckFailed, match='change the timer only if none is refused'):
        RateParameter(timers, 'rate_hz', TOPIC).expect_refuses(*rates_hz)


def test_a_node_that_publishes_as_fast_as_it_can_passes_the_check_of_refusals(monkeypatch):
    timers = OldTimers(monkeypatch, of_any=False)
    rates_hz = iter([3_000.0, 1_500.0, 2_000.0, 900.0])
    monkeypatch.setattr(RateParameter, '_measure', lambda *_: (next(rates_hz), CheckFailed))
    RateParameter(timers, 'rate_hz', TOPIC).expect_refuses(0.0, 60.0)


@pytest.mark.parametrize(
    ('seen_hz', 'cause', 'is_explained'),
    [
        (92.5, 'another rate', True),
        (62.5, 'another rate', False),
        (50.0, 'another rate', False),
        (25.0, 'another rate', False),
        (80.0, rate_failure.AT_ONCE, True),
        (50.0, rate_failure.AT_ONCE, False),
    ],
)
def test_a_rate_of_all_changes_together_is_explained_with_their_timers(
    seen_hz, cause, is_explained
):
    with pytest.raises(CheckFailed) as failed:
        fail(expected='50 Hz', seen='another', hint='', cause=cause)
    said = []
    for taken_hz in [12.5, 50.0], [12.5, 30.0, 50.0]:  # of two timers, another sentence tells
        try:
            older_timers.expect_none('rate_hz', seen_hz, taken_hz, failed=failed.value)
        except CheckFailed as explained:
            said.append((len(taken_hz), 'store each new timer as self.timer' in str(explained)))
    assert said == [(3, True)] * is_explained


@pytest.mark.slow
@pytest.mark.parametrize(('NodeClass', 'words'), OF_BOTH)
def test_a_fundamental_mistake_fails_both_checks(run, NodeClass, words):
    run(NodeClass)
    for look in look_at_the_rate, look_at_refusals:
        with pytest.raises(CheckFailed, match=words):
            look()


def test_a_callback_that_refuses_other_parameters_fails_with_advice(run):
    run(adjustable.RefusesOthers)
    words = 'use_sim_time, another parameter, to be set, .* check only those whose name is'
    with pytest.raises(CheckFailed, match=words):
        look_at_the_rate()


@pytest.mark.slow
def test_a_node_of_another_name_is_named(run):
    run(adjustable.FiveHz)
    words = 'expected the node /adjustable_publisher, saw /kinematics_publisher: run the cell'
    with pytest.raises(CheckFailed, match=words):
        look_at_the_rate()


FORMLESS = {
    'no such type': GetParameters.Response(values=[ParameterValue(type=77)]),
    'two for one': GetParameters.Response(values=[ParameterValue(type=3)] * 2),
    'no result': SetParameters.Response(),
    'a result too many': SetParameters.Response(results=[SetParametersResult()] * 3),
}


@pytest.mark.parametrize('response', FORMLESS.values(), ids=FORMLESS)
def test_malformed_answers_of_parameter_services_fail_with_advice(monkeypatch, response):
    """Otherwise they would stop the check, and a person would have to grade instead of a zero."""
    monkeypatch.setattr(NodeParameters, '_call', lambda *_: response)
    parameters = NodeParameters('/adjustable_publisher')
    is_told = isinstance(response, GetParameters.Response)
    ask, values = (parameters.get, ()) if is_told else (parameters.set, (7.0, 70.0))
    words = '/adjustable_publisher/.et_parameters.*, saw .*: leave the parameter services to'
    with pytest.raises(CheckFailed, match=words):
        ask('rate_hz', *values)


def test_parameters_are_read_and_set(run):
    run(adjustable.Adjustable)
    parameters = node_parameters('/adjustable_publisher')
    taken, refused = parameters.set('rate_hz', 7.0, 70.0)
    assert (taken.successful, refused.successful) == (True, False)
    assert refused.reason == 'rate_hz is from 1 to 50'
    assert parameters.get('rate_hz') == 7.0


def test_a_client_that_never_receives_a_response_is_replaced(run, monkeypatch):
    """Fast DDS makes such clients now and then, of a node that has answered thousands of times."""
    call_async, without = Client.call_async, []

    def call(client, request):
        without[:] = without or [client]
        return Future() if client in without else call_async(client, request)

    run(adjustable.Adjustable)
    monkeypatch.setattr(Client, 'call_async', call)
    monkeypatch.setattr(parameters, 'MEETING_SEC', 0.1)
    assert NodeParameters('/adjustable_publisher').get('rate_hz') == 5.0
    assert without


def test_services_that_vanish_are_told_from_those_that_never_were(monkeypatch):
    ready = iter([True])
    monkeypatch.setattr(Client, 'service_is_ready', lambda client: next(ready, False))
    monkeypatch.setattr(parameters, 'SERVICES_SEC', 0.1)
    monkeypatch.setattr(parameters, 'MEETING_SEC', 0.1)
    with pytest.raises(
        CheckFailed, match='expected /gone to answer get_parameters, saw no answer'
    ):
        NodeParameters('/gone').get('rate_hz')
    with pytest.raises(CheckFailed, match='expected the parameter services of /gone, saw none'):
        NodeParameters('/gone').get('rate_hz')


@pytest.mark.parametrize(('type_name', 'default'), [('INTEGER', '5'), ('STRING', "'5.0'")])
def test_a_default_of_another_type_is_named(type_name, default):
    said = f"Wrong parameter type, expected 'Type.{type_name}' got 'Type.DOUBLE'"
    with pytest.raises(CheckFailed, match=f'declare it with 5.0, not {default}$'):
        fail_refused('rate_hz', 5.0, SetParametersResult(successful=False, reason=said))
