"""Publishers whose rate is a parameter: right in several ways, and wrong in several."""

import contextlib
import threading
import time

from five_hz import FiveHz
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy._rclpy_pybind11 import InvalidHandle

LIMITS = ParameterDescriptor(
    floating_point_range=[FloatingPointRange(from_value=1.0, to_value=50.0)]
)
REFUSED = {'successful': False, 'reason': 'rate_hz is from 1 to 50'}


class Adjustable(FiveHz):
    """Checks the value in one callback, and makes a new timer there, as most students do."""

    default = 5.0
    descriptor = ParameterDescriptor()

    def __init__(self):
        super().__init__('adjustable_publisher')

    def start(self, period_sec):
        self.declare_parameter('rate_hz', self.default, self.descriptor)
        self.begin()
        self.add_on_set_parameters_callback(self.judge)

    def begin(self):
        self.timer = self.create_timer(1.0 / self.get_parameter('rate_hz').value, self.publish)

    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                if not 1.0 <= parameter.value <= 50.0:
                    return SetParametersResult(**REFUSED)
                self.change(parameter.value)
        return SetParametersResult(successful=True)

    def change(self, rate_hz):
        self.destroy_timer(self.timer)
        self.timer = self.create_timer(1.0 / rate_hz, self.publish)


class CancelsTheTimer(Adjustable):
    def change(self, rate_hz):
        self.timer.cancel()
        self.timer = self.create_timer(1.0 / rate_hz, self.publish)


class SetsThePeriod(Adjustable):
    def change(self, rate_hz):
        self.timer.timer_period_ns = int(1e9 / rate_hz)


class ChangesAfterwards(Adjustable):
    def start(self, period_sec):
        super().start(period_sec)
        self.add_post_set_parameters_callback(self.take)

    def change(self, rate_hz):
        pass

    def take(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                super().change(parameter.value)


class LimitsInTheDescriptor(ChangesAfterwards):
    descriptor = LIMITS

    def judge(self, parameters):
        return SetParametersResult(successful=True)


class ReadsInEachTick(Adjustable):
    descriptor = LIMITS

    def begin(self):
        self.last = self.get_clock().now()
        self.timer = self.create_timer(0.01, self.look)

    def look(self):
        now = self.get_clock().now()
        if (now - self.last).nanoseconds / 1e9 >= 1.0 / self.get_parameter('rate_hz').value:
            self.last = now
            self.publish()

    def judge(self, parameters):
        return SetParametersResult(successful=True)


class SleepsInAThread(ReadsInEachTick):
    def begin(self):
        threading.Thread(target=self.loop, daemon=True).start()

    def loop(self):
        with contextlib.suppress(InvalidHandle):  # the node is gone
            while self.context.ok():
                self.publish()
                time.sleep(1.0 / self.get_parameter('rate_hz').value)


class TypesItself(Adjustable):
    default = 5
    descriptor = ParameterDescriptor(dynamic_typing=True)


class ReadsOnce(LimitsInTheDescriptor):
    def take(self, parameters):
        pass


class KeepsTheOldTimer(Adjustable):
    def change(self, rate_hz):
        self.timer = self.create_timer(1.0 / rate_hz, self.publish)


class OneBehind(Adjustable):
    descriptor = LIMITS

    def change(self, rate_hz):
        super().change(self.get_parameter('rate_hz').value)


class Integer(Adjustable):
    default = 5


class AnotherDefault(Adjustable):
    default = 1.0


class NotDeclared(Adjustable):
    def start(self, period_sec):
        self.timer = self.create_timer(0.2, self.publish)
        self.declare_parameter('rate', 5.0)


class RefusesOthers(Adjustable):
    def judge(self, parameters):
        if not 1.0 <= parameters[0].value <= 50.0:
            return SetParametersResult(**REFUSED)
        self.change(parameters[0].value)
        return SetParametersResult(successful=True)


class ReturnsNothing(Adjustable):
    def judge(self, parameters):
        super().judge(parameters)


class SetsThoughRefusing(Adjustable):
    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz' and parameter.value > 0.0:
                self.change(parameter.value)
        return super().judge(parameters)


class GivesNoReason(Adjustable):
    def judge(self, parameters):
        return SetParametersResult(successful=super().judge(parameters).successful)


class TakesAll(Adjustable):
    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                self.change(max(parameter.value, 0.1))
        return SetParametersResult(successful=True)


class Corrects(Adjustable):
    def start(self, period_sec):
        super().start(period_sec)
        self.add_pre_set_parameters_callback(self.correct)

    def correct(self, parameters):
        return [
            type(p)(p.name, value=min(max(p.value, 1.0), 50.0)) if p.name == 'rate_hz' else p
            for p in parameters
        ]


class JudgesTheFirst(ChangesAfterwards):
    def judge(self, parameters):
        return super().judge(parameters[:1])


class SaysYesTooSoon(ChangesAfterwards):
    def judge(self, parameters):
        for parameter in parameters:
            return super().judge([parameter])


class KeepsTheLastWord(ChangesAfterwards):
    def judge(self, parameters):
        for parameter in parameters:
            result = super().judge([parameter])
        return result


class ChangesByTheFirst(ChangesAfterwards):
    def take(self, parameters):
        super().take(parameters[:1])


class LetsNaNThrough(ReadsInEachTick):
    descriptor = ParameterDescriptor()

    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz' and (parameter.value < 1.0 or parameter.value > 50.0):
                return SetParametersResult(**REFUSED)
        return SetParametersResult(successful=True)


class RefusesTheLimits(Adjustable):
    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz' and parameter.value in (1.0, 50.0):
                return SetParametersResult(**REFUSED)
        return super().judge(parameters)


class DividesFirst(Adjustable):
    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                self.period_sec = 1.0 / parameter.value
        return super().judge(parameters)
