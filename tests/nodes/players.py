"""Programs that visit targets, right and wrong in several ways: `players.py VARIANT --ros-args`.

The first of them is the exercise's answer.
"""

import sys
import threading
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import Point
from my_robot_basics.checks.values.solutions import request, solve
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK

sys.path.insert(0, str(Path(__file__).parents[2] / 'solutions/12_package/arm_player'))

from arm_player.arm_player import ENDS, LATCHED, ArmPlayer


class Program(ArmPlayer):
    """A class, and the `main` that runs it."""

    def targets(self):
        numbers = self.get_parameter('targets').value
        return list(zip(numbers[::2], numbers[1::2], strict=True))

    def wait_for_servers(self):
        self.solver.wait_for_service()
        self.arm.wait_for_server()

    def goal(self, answer):
        return MoveArm.Goal(position=answer.elbow_up, speed=0.5)

    def ask(self, x, y):
        return self.solver.call_async(SolveIK.Request(target=Point(x=x, y=y)))

    def report(self, words):
        self.done.publish(String(data=' '.join(words)))

    @classmethod
    def main(cls):
        player = cls()
        player.play()
        rclpy.spin(player)


# --- right ---------------------------------------------------------------------------------------


class Usual(Program):
    pass


class Callbacks(Program):
    """Each answer leads to the next step; a timer looks for the servers."""

    def play(self):
        self.left, self.words = self.targets(), []
        self.timer = self.create_timer(0.1, self.begin)

    def begin(self):
        if self.solver.service_is_ready() and self.arm.server_is_ready():
            self.timer.cancel()
            self.next()

    def next(self, *words):
        self.words += words
        if not self.left:
            self.report(self.words)
            return
        self.ask(*self.left.pop(0)).add_done_callback(self.answered)

    def answered(self, future):
        if not future.result().reachable:
            self.next('unreachable')
            return
        goal = self.goal(future.result())
        self.arm.send_goal_async(goal).add_done_callback(self.accepted)

    def accepted(self, future):
        if not future.result().accepted:
            self.next('rejected')
            return
        future.result().get_result_async().add_done_callback(self.ended)

    def ended(self, future):
        self.next(ENDS[future.result().status])


class Awaits(Program):
    """One coroutine, which no callback group blocks."""

    async def visit(self, x, y):
        answer = await self.ask(x, y)
        if not answer.reachable:
            return 'unreachable'
        handle = await self.arm.send_goal_async(self.goal(answer))
        if not handle.accepted:
            return 'rejected'
        return ENDS[(await handle.get_result_async()).status]

    async def draw(self):
        self.report([await self.visit(x, y) for x, y in self.targets()])

    @classmethod
    def main(cls):
        player = cls()
        player.wait_for_servers()
        rclpy.get_global_executor().create_task(player.draw)
        rclpy.spin(player)


class Threads(Program):
    """Blocking calls in a thread, and an executor with enough threads."""

    def wait_for(self, future):
        over = threading.Event()
        future.add_done_callback(lambda _: over.set())
        over.wait()
        return future.result()

    @classmethod
    def main(cls):
        player = cls()
        executor = MultiThreadedExecutor(4)
        executor.add_node(player)
        threading.Thread(target=player.play, daemon=True).start()
        executor.spin()


class BlocksInAGroup(Threads):
    """Blocks in a timer's callback, in a group that lets the others run."""

    @classmethod
    def main(cls):
        player = cls()
        player.once = player.create_timer(0.1, player.tick, ReentrantCallbackGroup())
        executor = MultiThreadedExecutor(4)
        executor.add_node(player)
        executor.spin()

    def tick(self):
        self.once.cancel()
        self.play()


class AsksAhead(Program):
    """Requests all solutions first, which nothing forbids."""

    def play(self):
        self.wait_for_servers()
        self.answers = {target: self.wait_for(self.ask(*target)) for target in self.targets()}
        super().play()

    def visit(self, x, y):
        if not self.answers[x, y].reachable:
            return 'unreachable'
        handle = self.wait_for(self.arm.send_goal_async(self.goal(self.answers[x, y])))
        if not handle.accepted:
            return 'rejected'
        return ENDS[self.wait_for(handle.get_result_async()).status]


class MakesThemLate(Program):
    """Makes a client and the publisher only when they are needed; writes commas."""

    def __init__(self):
        Node.__init__(self, 'arm_player')
        self.declare_parameter('targets', [0.9, 0.3])
        self.solver = self.create_client(SolveIK, '/solve_ik')

    def play(self):
        self.arm = ActionClient(self, MoveArm, '/move_arm')
        self.wait_for_servers()
        words = [self.visit(x, y) for x, y in self.targets()]
        self.done = self.create_publisher(String, '/arm_player/done', LATCHED)
        self.done.publish(String(data=', '.join(words)))


RIGHT = (Usual, Callbacks, Awaits, Threads, BlocksInAGroup, AsksAhead, MakesThemLate)


# --- wrong ---------------------------------------------------------------------------------------


class StopsAtTheFirstUnreachable(Program):
    def play(self):
        self.wait_for_servers()
        words = []
        for x, y in self.targets():
            words.append(self.visit(x, y))
            if words[-1] == 'unreachable':
                break
        self.report(words)


class RaisesAtAnUnreachable(Program):
    def visit(self, x, y):
        answer = self.wait_for(self.ask(x, y))
        if not answer.reachable:
            raise ValueError(answer.message)
        return super().visit(x, y)


class GivesUpWhenCanceled(Program):
    def visit(self, x, y):
        word = super().visit(x, y)
        while word == 'canceled':
            rclpy.spin_once(self)
        return word


class WaitsForARejectedGoal(Program):
    def visit(self, x, y):
        answer = self.wait_for(self.ask(x, y))
        if not answer.reachable:
            return 'unreachable'
        handle = self.wait_for(self.arm.send_goal_async(self.goal(answer)))
        return ENDS[self.wait_for(handle.get_result_async()).status]


class SendsAllGoalsAtOnce(Program):
    def play(self):
        self.wait_for_servers()
        answers = [self.wait_for(self.ask(x, y)) for x, y in self.targets()]
        goals = [self.goal(answer) for answer in answers if answer.reachable]
        sent = [self.arm.send_goal_async(goal) for goal in goals]
        results = [self.wait_for(each).get_result_async() for each in sent]
        self.report([ENDS[self.wait_for(result).status] for result in results])


class ReportsBeforeTheEnd(Program):
    def play(self):
        self.wait_for_servers()
        self.report(['succeeded'] * len(self.targets()))
        super().play()


class ReportsEachTarget(Program):
    def visit(self, x, y):
        word = super().visit(x, y)
        self.report([word])
        return word


class CallsInACallback(Program):
    def play(self):
        self.once = self.create_timer(0.1, self.tick)

    def tick(self):
        self.once.cancel()
        self.wait_for_servers()
        x, y = self.targets()[0]
        self.solver.call(SolveIK.Request(target=Point(x=x, y=y)))


class NeverWaitsForTheServer(Program):
    def play(self):
        self.report([self.visit(x, y) for x, y in self.targets()])


class NeverWaitsForTheArm(Program):
    def play(self):
        self.solver.wait_for_service()
        self.report([self.visit(x, y) for x, y in self.targets()])


class NeverWaitsForTheSolver(Program):
    def play(self):
        self.arm.wait_for_server()
        self.report([self.visit(x, y) for x, y in self.targets()])


class GivesUpAfterASecond(Program):
    def visit(self, x, y):
        answer = self.wait_for(self.ask(x, y))
        if not answer.reachable:
            return 'unreachable'
        handle = self.wait_for(self.arm.send_goal_async(self.goal(answer)))
        if not handle.accepted:
            return 'rejected'
        result = handle.get_result_async()
        rclpy.spin_until_future_complete(self, result, timeout_sec=1.0)
        return ENDS[result.result().status] if result.done() else 'aborted'


class GivesUpAfterFiveSeconds(Program):
    def visit(self, x, y):
        handle = self.wait_for(self.arm.send_goal_async(self.goal(self.wait_for(self.ask(x, y)))))
        result = handle.get_result_async()
        rclpy.spin_until_future_complete(self, result, timeout_sec=5.0)
        return ENDS[result.result().status] if result.done() else 'aborted'


class WaitsASecondForTheArm(NeverWaitsForTheArm):
    def visit(self, x, y):
        self.arm.wait_for_server(timeout_sec=1.0)
        return super().visit(x, y)


class WaitsFiveSecondsForTheSolver(NeverWaitsForTheSolver):
    def visit(self, x, y):
        self.solver.wait_for_service(timeout_sec=5.0)
        return super().visit(x, y)


class ElbowDown(Program):
    def visit(self, x, y):
        answer = self.wait_for(self.ask(x, y))
        goal = MoveArm.Goal(position=answer.elbow_down, speed=0.5)
        handle = self.wait_for(self.arm.send_goal_async(goal))
        return ENDS[self.wait_for(handle.get_result_async()).status]


class SolvesItself(AsksAhead):
    def goal(self, answer):
        return MoveArm.Goal(position=solve(request(*self.targets()[0])).elbow_up, speed=0.5)


class OtherSpeed(AsksAhead):
    def goal(self, answer):
        return MoveArm.Goal(position=answer.elbow_up, speed=1.0)


class SwapsXAndY(Program):
    def ask(self, x, y):
        return super().ask(y, x)

    visit = WaitsForARejectedGoal.visit


class FixedTargets(Program):
    def play(self):
        self.wait_for_servers()
        self.report([self.visit(x, y) for x, y in ((1.2, 0.8), (0.9, -0.9))])


class AlwaysSucceeded(Program):
    def visit(self, x, y):
        super().visit(x, y)
        return 'succeeded'


class SaysCancelled(Program):
    def visit(self, x, y):
        return super().visit(x, y).replace('canceled', 'cancelled')


class Volatile(Program):
    def __init__(self):
        super().__init__()
        self.destroy_publisher(self.done)
        self.done = self.create_publisher(String, '/arm_player/done', 10)


class EndsAfterTheReport(Program):
    @classmethod
    def main(cls):
        player = cls()
        player.play()
        rclpy.spin_once(player, timeout_sec=0.5)


class SleepsAfterTheReport(Program):
    @classmethod
    def main(cls):
        cls().play()
        time.sleep(1.5)


class SleepsFiveSecondsAfterTheReport(Program):
    @classmethod
    def main(cls):
        cls().play()
        time.sleep(5.0)


class AnotherTopic(Program):
    def __init__(self):
        super().__init__()
        self.destroy_publisher(self.done)
        self.done = self.create_publisher(String, '/done', LATCHED)


def main():
    program = globals()[sys.argv.pop(1)]
    try:
        rclpy.init()
        program.main()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
