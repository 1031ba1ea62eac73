"""The errors of `run` for an object that it cannot run, of which nothing is left behind."""

import math
from dataclasses import dataclass
from functools import cached_property

import pytest
from my_robot_basics.live import run, stop
from my_robot_basics.session.errors import NotRunnable
from my_robot_basics.session.neighbours import nodes_here
from rclpy.node import Node
from std_msgs.msg import String


class Late(Node):
    def __init__(self):
        self.publisher = self.create_publisher(String, '/late', 10)
        super().__init__('late')


class Never(Node):
    def __init__(self):
        self.count = 0


class OwnMistake(Node):
    def __init__(self):
        super().__init__('own_mistake')
        self.publisher = self.create_publsher(String, '/late', 10)


class Returns(Node):
    def __init__(self):
        super().__init__('returns')
        self.publisher = self.create_publisher(String, '/late', 10)
        return self


@pytest.mark.parametrize('NodeClass', [Late, Never])
def test_a_constructor_that_does_not_begin_with_super_init_is_reported(NodeClass):
    with pytest.raises(NotRunnable, match=rf'of {NodeClass.__name__} to begin with super\(\)\._'):
        run(NodeClass)


def test_another_error_in_a_constructor_is_raised_unchanged():
    with pytest.raises(AttributeError, match='create_publsher'):
        run(OwnMistake)
    stop()


class OwnClock(Node):
    def __init__(self):
        super().__init__('own_clock')
        self._clock = 0.0
        self.timer = self.create_timer(0.2, print)


class OwnParameters(Node):
    def __init__(self):
        super().__init__('own_parameters')
        self._parameters = {'rate_hz': 5.0}
        self.declare_parameter('rate_hz', 5.0)


class OwnClockAndMistake(Node):
    def __init__(self):
        super().__init__('own_clock_and_mistake')
        self._clock = 0.0
        raise ZeroDivisionError


@pytest.mark.parametrize(
    ('NodeClass', 'attribute'), [(OwnClock, '_clock'), (OwnParameters, '_parameters')]
)
def test_an_attribute_of_node_that_a_constructor_overwrites_is_named(NodeClass, attribute):
    with pytest.raises(NotRunnable, match=f'{NodeClass.__name__} to leave `self.{attribute}` al'):
        run(NodeClass)
    stop()


def test_an_error_that_no_overwritten_attribute_causes_is_raised_unchanged():
    with pytest.raises(ZeroDivisionError):
        run(OwnClockAndMistake)
    stop()


def test_a_constructor_that_returns_a_value_raises_the_error_of_python():
    with pytest.raises(TypeError, match=r"__init__\(\) should return None, not 'Returns'"):
        run(Returns)
    assert not any(isinstance(node, Returns) for node in nodes_here())
    stop()


@dataclass
class Data(Node):
    rate_hz: float = 5.0

    def __post_init__(self):
        super().__init__('data')


def test_a_class_whose_nodes_can_not_be_hashed_is_refused_before_there_is_a_node():
    with pytest.raises(NotRunnable, match='remove `@dataclass` above the class'):
        run(Data)
    assert not any(isinstance(node, Data) for node in nodes_here())


@pytest.mark.parametrize(
    ('thing', 'words'),
    [
        (math, 'the module math: write run(math.…)'),
        ('Late', "derived from rclpy.node.Node, saw 'Late'"),
        (dict, "saw <class 'dict'>"),
    ],
)
def test_an_object_that_is_not_a_node_class_is_named_in_the_error(thing, words):
    with pytest.raises(NotRunnable) as refused:
        run(thing)
    assert words in str(refused.value)


class Handles(Node):
    """Its method has a name that Node uses itself."""

    def __init__(self):
        super().__init__('handles')

    def handle(self, message):
        pass


class Mixin:
    def timers(self):
        return []


class MixedIn(Mixin, Node):
    def __init__(self):
        super().__init__('mixed_in')


class Static(Node):
    @staticmethod
    def guards():
        return []


@pytest.mark.parametrize(
    ('NodeClass', 'name'), [(Handles, 'handle'), (MixedIn, 'timers'), (Static, 'guards')]
)
def test_a_method_that_hides_a_property_of_node_is_named_in_the_error(NodeClass, name):
    words = f'expected {NodeClass.__name__} to have no method `{name}`, saw one: .* another name'
    with pytest.raises(NotRunnable, match=words):
        run(NodeClass)


class HalfMade(Node):
    """Node's own constructor calls `get_parameter`, and so raises when half of the node exists."""

    def __init__(self):
        super().__init__('half_made')

    def get_parameter(self):
        return 5.0


@pytest.mark.starts
def test_an_error_from_the_constructor_of_rclpys_node_is_raised_unchanged():
    with pytest.raises(TypeError, match=r'HalfMade.get_parameter\(\) takes 1 positional argument'):
        run(HalfMade)
    stop()


class Allowed(Node):
    """Redefines names of Node, as an attribute, a property and a method, and can still be spun."""

    def __init__(self):
        super().__init__('allowed')
        self.is_destroyed = False

    def publishers(self):
        return []

    @cached_property
    def waitables(self):
        return []

    def destroy_node(self):
        self.is_destroyed = True
        super().destroy_node()


@pytest.mark.starts
def test_a_node_that_redefines_names_harmless_to_executors_is_run():
    node = run(Allowed)
    stop()
    assert node.is_destroyed
