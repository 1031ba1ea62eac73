"""Programs `arm_player` for lesson 12 that are written in other ways than ours."""

HEAD = """import rclpy
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSDurabilityPolicy, QoSReliabilityPolicy, QoSHistoryPolicy
from action_msgs.msg import GoalStatus
from std_msgs.msg import String
from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK
"""

INIT = """

class ArmPlayer(Node):
    def __init__(self):
        super().__init__('arm_player')
        self.declare_parameter('targets', [1.2, 0.8])
        self.targets = list(self.get_parameter('targets').get_parameter_value().double_array_value)
        self.group = ReentrantCallbackGroup()
        groups = {'callback_group': self.group}
        self.ik_client = self.create_client(SolveIK, '/solve_ik', **groups)
        self.move_client = ActionClient(self, MoveArm, '/move_arm', **groups)
        qos = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
                         reliability=QoSReliabilityPolicy.RELIABLE,
                         history=QoSHistoryPolicy.KEEP_LAST)
        self.done_pub = self.create_publisher(String, '/arm_player/done', qos)
        self.words = []
"""

MAIN = """

def main(args=None):
    rclpy.init(args=args)
    node = ArmPlayer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""

STYLES = {
    'tutorial': HEAD
    + INIT
    + """        self.index = 0
        self.get_logger().info('Waiting for servers...')
        while not self.ik_client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('service not available, waiting again...')
        while not self.move_client.wait_for_server(timeout_sec=1.0):
            self.get_logger().info('action server not available, waiting again...')
        self.process_next()

    def process_next(self):
        if self.index + 1 >= len(self.targets):
            msg = String()
            msg.data = ' '.join(self.words)
            self.done_pub.publish(msg)
            self.get_logger().info(f'Done: {msg.data}')
            return
        req = SolveIK.Request()
        req.target.x = self.targets[self.index]
        req.target.y = self.targets[self.index + 1]
        self.index += 2
        self.ik_client.call_async(req).add_done_callback(self.ik_callback)

    def ik_callback(self, future):
        try:
            response = future.result()
        except Exception as e:
            self.get_logger().error(f'Service call failed {e!r}')
            return
        if not response.reachable:
            self.finish('unreachable')
            return
        goal_msg = MoveArm.Goal()
        goal_msg.position = response.elbow_up
        goal_msg.speed = 0.5
        self._send_goal_future = self.move_client.send_goal_async(
            goal_msg, feedback_callback=self.feedback_callback)
        self._send_goal_future.add_done_callback(self.goal_response_callback)

    def goal_response_callback(self, future):
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.get_logger().info('Goal rejected :(')
            self.finish('rejected')
            return
        self.get_logger().info('Goal accepted :)')
        self._get_result_future = goal_handle.get_result_async()
        self._get_result_future.add_done_callback(self.get_result_callback)

    def get_result_callback(self, future):
        self.finish({4: 'succeeded', 5: 'canceled', 6: 'aborted'}[future.result().status])

    def feedback_callback(self, feedback_msg):
        self.get_logger().info(f'{feedback_msg.feedback.remaining:.2f} rad left')

    def finish(self, word):
        self.words.append(word)
        self.process_next()
"""
    + MAIN,
    'generator': HEAD
    + INIT
    + """        self.steps = self.plan()
        self.wait = self.create_timer(0.1, self.poll)

    def poll(self):
        if self.ik_client.service_is_ready() and self.move_client.server_is_ready():
            self.destroy_timer(self.wait)
            self.advance()

    def advance(self, future=None):
        try:
            nxt = self.steps.send(future.result() if future else None)
        except StopIteration:
            return
        nxt.add_done_callback(self.advance)

    def plan(self):
        it = iter(self.targets)
        words = 'succeeded', 'canceled', 'aborted'
        names = {getattr(GoalStatus, f'STATUS_{word.upper()}'): word for word in words}
        for x in it:
            y = next(it)
            request = SolveIK.Request()
            request.target.x = x
            request.target.y = y
            reply = yield self.ik_client.call_async(request)
            if reply.reachable is False:
                self.words += ['unreachable']
                continue
            handle = yield self.move_client.send_goal_async(
                MoveArm.Goal(position=reply.elbow_up, speed=0.5))
            if not handle.accepted:
                self.words += ['rejected']
                continue
            end = yield handle.get_result_async()
            self.words += [names[end.status]]
        self.done_pub.publish(String(data=' '.join(self.words)))
"""
    + MAIN,
    'awaits': HEAD
    + INIT
    + """        self.timer = self.create_timer(0.2, self.start, self.group)

    async def start(self):
        if not (self.ik_client.service_is_ready() and self.move_client.server_is_ready()):
            return
        self.timer.cancel()
        points = list(zip(self.targets[0::2], self.targets[1::2]))
        for x, y in points:
            word = await self.visit(x, y)
            self.words.append(word)
        self.done_pub.publish(String(data=' '.join(self.words)))

    async def visit(self, x, y):
        request = SolveIK.Request()
        request.target.x, request.target.y = x, y
        response = await self.ik_client.call_async(request)
        if not response.reachable:
            return 'unreachable'
        handle = await self.move_client.send_goal_async(
            MoveArm.Goal(position=list(response.elbow_up), speed=0.5))
        if not handle.accepted:
            return 'rejected'
        result = await handle.get_result_async()
        match result.status:
            case GoalStatus.STATUS_SUCCEEDED:
                return 'succeeded'
            case GoalStatus.STATUS_CANCELED:
                return 'canceled'
            case _:
                return 'aborted'
"""
    + MAIN,
    'asyncio_loop': 'import asyncio\n'
    + HEAD
    + INIT
    + """
    async def play(self):
        while not (self.ik_client.service_is_ready() and self.move_client.server_is_ready()):
            await asyncio.sleep(0.1)
        for x, y in zip(self.targets[::2], self.targets[1::2]):
            self.words.append(await self.visit(x, y))
        self.done_pub.publish(String(data=' '.join(self.words)))

    async def visit(self, x, y):
        req = SolveIK.Request()
        req.target.x, req.target.y = x, y
        ans = await done(self.ik_client.call_async(req))
        if not ans.reachable:
            return 'unreachable'
        goal = MoveArm.Goal(position=ans.elbow_up, speed=0.5)
        handle = await done(self.move_client.send_goal_async(goal))
        if not handle.accepted:
            return 'rejected'
        res = await done(handle.get_result_async())
        return {GoalStatus.STATUS_SUCCEEDED: 'succeeded',
                GoalStatus.STATUS_CANCELED: 'canceled'}.get(res.status, 'aborted')


async def done(future):
    while not future.done():
        await asyncio.sleep(0.01)
    return future.result()


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.005)


async def run(node):
    await asyncio.gather(spin(node), node.play())


def main():
    rclpy.init()
    node = ArmPlayer()
    try:
        asyncio.run(run(node))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
""",
    'send_goal_in_a_thread': 'import threading\n'
    + HEAD
    + INIT
    + """        threading.Thread(target=self.play, daemon=True).start()

    def play(self):
        self.ik_client.wait_for_service()
        self.move_client.wait_for_server()
        for x, y in zip(*[iter(self.targets)] * 2):
            req = SolveIK.Request()
            req.target.x, req.target.y = x, y
            ans = self.ik_client.call(req)
            if not ans.reachable:
                self.words.append('unreachable')
                continue
            res = self.move_client.send_goal(MoveArm.Goal(position=ans.elbow_up, speed=0.5))
            words = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}
            self.words.append(words.get(res.status, 'rejected'))
        self.done_pub.publish(String(data=' '.join(self.words)))
"""
    + MAIN,
    'no_class': HEAD
    + """

def main():
    rclpy.init()
    node = rclpy.create_node('arm_player', automatically_declare_parameters_from_overrides=True)
    try:
        solve = node.create_client(SolveIK, 'solve_ik')
        move = ActionClient(node, MoveArm, 'move_arm')
        move.wait_for_server()
        solve.wait_for_service()

        def get(future):
            while not future.done():
                rclpy.spin_once(node)
            return future.result()

        n = node.get_parameter('targets').value
        report = []
        while len(n) >= 2:
            x, y, *n = n
            q = SolveIK.Request()
            q.target.x = x
            q.target.y = y
            a = get(solve.call_async(q))
            if a.reachable:
                g = get(move.send_goal_async(MoveArm.Goal(position=a.elbow_up, speed=0.5)))
                if g.accepted:
                    r = get(g.get_result_async())
                    report.append(['', '', '', '', 'succeeded', 'canceled', 'aborted'][r.status])
                else:
                    report.append('rejected')
            else:
                report.append('unreachable')
        qos = QoSProfile(depth=10, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
        pub = node.create_publisher(String, '~/done', qos)
        pub.publish(String(data=' '.join(report)))
        while rclpy.ok():
            rclpy.spin_once(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        ...
    rclpy.try_shutdown()
""",
}
