"""Packages for lesson 12 that are right, in unusual ways."""

from package_changes import DRIVER, PLAYER, SETUP, Change, Files, swap, without
from player_styles import STYLES


def _one_module(files: Files) -> None:
    driver, player = (
        files.pop(name).replace('def main', f'def main_{n}')
        for n, name in (('driver', DRIVER), ('player', PLAYER))
    )
    files['arm_player/nodes.py'] = f'{driver}\n\n{player}'
    swap(
        SETUP,
        ('arm_driver:main', 'nodes:main_driver'),
        ('arm_player.arm_player:main', 'arm_player.nodes:main_player'),
    )(files)


def _entry_points_in_setup_cfg(files: Files) -> None:
    head, rest = files[SETUP].split('    entry_points={')
    files[SETUP] = head + rest.split('    },\n', maxsplit=1)[1]
    files['setup.cfg'] += (
        '[options.entry_points]\nconsole_scripts =\n'
        '    arm_driver = arm_player.arm_driver:main\n'
        '    arm_player = arm_player.arm_player:main\n'
    )


_COROUTINE = (
    ('def visit', 'async def visit'),
    ('def play', 'async def play'),
    ('self.wait_for(self', '(await self'),
    ('self.wait_for(goal_handle', '(await goal_handle'),
    ('words = [self.visit', 'words = [await self.visit'),
    ('        player.play()\n', '        rclpy.get_global_executor().create_task(player.play)\n'),
)
_FOUR_THREADS = (
    (
        'from rclpy.executors import ExternalShutdownException\n',
        'from rclpy.callback_groups import ReentrantCallbackGroup\n'
        'from rclpy.duration import Duration\n'
        'from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor\n',
    ),
    (
        'self.execute, **callbacks)',
        'self.execute, callback_group=ReentrantCallbackGroup(), **callbacks)',
    ),
    ('async def execute', 'def execute'),
    ('await self.sleep(0.05)', 'self.get_clock().sleep_for(Duration(seconds=0.05))'),
    ('rclpy.spin(ArmDriver())', 'rclpy.spin(ArmDriver(), MultiThreadedExecutor(4))'),
)

RIGHT = (
    Change('usual', lambda files: None),
    Change('one_module', _one_module),
    Change('entry_points_in_setup_cfg', _entry_points_in_setup_cfg),
    Change('coroutine', swap(PLAYER, *_COROUTINE)),
    Change(
        'two_nodes_and_threads',
        swap(
            DRIVER,
            (
                'import rclpy\n',
                'import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\n',
            ),
            ('rclpy.spin(ArmDriver())', 'rclpy.spin(ArmDriver(), MultiThreadedExecutor(2))'),
        ),
    ),
    Change('blocks_one_of_four_threads', swap(DRIVER, *_FOUR_THREADS)),
    # setup.py names the folder: Python imports it without __init__.py, on a robot, too
    Change('no_init_file', without('arm_player/__init__.py')),
    Change('words_as_a_list', swap(PLAYER, ("' '.join(words)", 'str(words)'))),
    Change(
        'commas_and_a_log',
        swap(
            PLAYER,
            ("' '.join(words)", "', '.join(words)"),
            ('numbers = ', "print('hi'); numbers = "),
        ),
    ),
)


RIGHT += (
    Change(
        'events_executor',
        swap(
            DRIVER,
            (
                'from rclpy.executors import ExternalShutdownException\n',
                'from rclpy.executors import ExternalShutdownException\n'
                'from rclpy.experimental.events_executor import EventsExecutor\n',
            ),
            (
                '        rclpy.spin(ArmDriver())',
                '        executor = EventsExecutor()\n        executor.add_node(ArmDriver())\n'
                '        executor.spin()',
            ),
        ),
    ),
)


def _in_turn(files: Files) -> None:
    """Each target is visited from the callback of the previous one: nothing waits."""
    head, rest = files[PLAYER].split('    def play(self):')
    files[PLAYER] = f'{head}{_CHAIN}\n\ndef main():{rest.split("def main():")[1]}'


_CHAIN = """    def play(self):
        numbers = self.get_parameter('targets').value
        self.left = [*zip(numbers[::2], numbers[1::2], strict=True)]
        self.words = []
        self.looks = self.create_timer(0.1, self.begin)

    def begin(self):
        if self.solver.service_is_ready() and self.arm.server_is_ready():
            self.looks.cancel()
            self.visit_next()

    def visit_next(self):
        if not self.left:
            self.done.publish(String(data=' '.join(self.words)))
            return
        x, y = self.left.pop(0)
        asked = self.solver.call_async(SolveIK.Request(target=Point(x=x, y=y)))
        asked.add_done_callback(self.solved)

    def note(self, word):
        self.words.append(word)
        self.visit_next()

    def solved(self, future):
        if not future.result().reachable:
            return self.note('unreachable')
        goal = MoveArm.Goal(position=future.result().elbow_up, speed=0.5)
        self.arm.send_goal_async(goal).add_done_callback(self.answered)

    def answered(self, future):
        if not future.result().accepted:
            return self.note('rejected')
        result = future.result().get_result_async()
        result.add_done_callback(lambda end: self.note(ENDS[end.result().status]))
"""

_THREAD = (
    ('import rclpy\n', 'import threading\nimport time\n\nimport rclpy\n'),
    (
        '        player.play()\n',
        '        threading.Thread(target=player.play, daemon=True).start()\n',
    ),
    (
        '        rclpy.spin_until_future_complete(self, future)\n'
        '        if not future.done():\n            raise ExternalShutdownException\n',
        '        while not future.done():\n            time.sleep(0.01)\n',
    ),
)

RIGHT += (
    Change('in_turn', _in_turn),
    Change('plays_in_a_thread', swap(PLAYER, *_THREAD)),
    Change(
        'declares_no_default',
        swap(
            PLAYER,
            ("'targets', [1.2, 0.8, 0.9, -0.9]", "'targets', rclpy.Parameter.Type.DOUBLE_ARRAY"),
        ),
    ),
    Change(
        'shuts_down_as_the_tutorials_do',
        swap(
            DRIVER,
            ('    try:\n        rclpy.init()\n', '    rclpy.init()\n    try:\n'),
            (
                '    finally:\n        rclpy.try_shutdown()',
                '    finally:\n        if rclpy.ok():\n            rclpy.shutdown()',
            ),
        ),
    ),
)


def _no_dependencies(files: Files) -> None:
    lines = files['package.xml'].splitlines(keepends=True)
    files['package.xml'] = ''.join(line for line in lines if 'depend>' not in line)


def _module_of_its_own(files: Files) -> None:
    """The names of the outcomes are in a separate module beside the player."""
    head, rest = files[PLAYER].split('ENDS = {')
    ends, rest = rest.split('}\n', maxsplit=1)
    head = head.replace('from action_msgs.msg import GoalStatus\n', '')
    files[PLAYER] = f'{head.rstrip()}\n\nfrom .ends import ENDS\n\n{rest.lstrip()}'
    files['arm_player/ends.py'] = f'from action_msgs.msg import GoalStatus\n\nENDS = {{{ends}}}\n'


_SOLVES_FIRST = (
    (
        '[self.visit(x, y) for x, y in targets]',
        '[self.visit(answer) for answer in [self.solve(x, y) for x, y in targets]]',
    ),
    ('    def visit(self, x, y):\n', '    def visit(self, answer):\n'),
    (
        '        answer = self.wait_for(self.solver.call_async('
        'SolveIK.Request(target=Point(x=x, y=y))))\n',
        '',
    ),
    (
        '    def wait_for(self, future):\n',
        '    def solve(self, x, y):\n'
        '        asked = SolveIK.Request(target=Point(x=x, y=y))\n'
        '        return self.wait_for(self.solver.call_async(asked))\n\n'
        '    def wait_for(self, future):\n',
    ),
)

RIGHT += (
    Change(
        'finds_its_packages',
        swap(
            SETUP,
            ('import setup\n', 'import find_packages, setup\n'),
            ("packages=['arm_player']", "packages=find_packages(exclude=['test'])"),
        ),
    ),
    Change('module_of_its_own', _module_of_its_own),
    Change(
        'spins_once_and_again',
        swap(
            PLAYER,
            (
                '        rclpy.spin_until_future_complete(self, future)\n',
                '        while rclpy.ok() and not future.done():\n'
                '            rclpy.spin_once(self, timeout_sec=0.1)\n',
            ),
        ),
    ),
    Change('solves_all_before_it_moves', swap(PLAYER, *_SOLVES_FIRST)),
    Change(
        'numpy_and_arguments',
        swap(
            PLAYER,
            ('import rclpy\n', 'import numpy as np\nimport rclpy\n'),
            ('zip(numbers[::2], numbers[1::2], strict=True)', 'np.reshape(numbers, (-1, 2))'),
            ('def main():', 'def main(args=None):'),
            ('rclpy.init()', 'rclpy.init(args=args)'),
        ),
    ),
    Change(
        'suppresses_and_returns_0',
        swap(
            PLAYER,
            ('import rclpy\n', 'from contextlib import suppress\n\nimport rclpy\n'),
            ('    try:\n        rclpy.init()\n', '    rclpy.init()\n    with suppress(END):\n'),
            (
                '    except (KeyboardInterrupt, ExternalShutdownException):\n        pass\n'
                '    finally:\n        rclpy.try_shutdown()\n',
                '    rclpy.try_shutdown()\n    return 0\n',
            ),
            ('suppress(END)', 'suppress(KeyboardInterrupt, ExternalShutdownException)'),
        ),
    ),
)

RIGHT += (
    # build_package tells that, and it takes no points
    Change('no_dependencies', _no_dependencies),
    Change(
        'sleeps_after_the_report',
        swap(
            PLAYER,
            ('import rclpy\n', 'import time\n\nimport rclpy\n'),
            ('        rclpy.spin(player)', '        while True:\n            time.sleep(0.1)'),
        ),
    ),
    Change(
        'client_for_each_target',
        swap(
            PLAYER,
            (
                '        answer = self.wait_for(self.solver.call',
                "        solver = self.create_client(SolveIK, '/solve_ik')\n"
                '        solver.wait_for_service()\n'
                '        answer = self.wait_for(solver.call',
            ),
        ),
    ),
    Change(
        'threads_of_an_executor',
        swap(
            PLAYER,
            (
                'import ExternalShutdownException\n',
                'import ExternalShutdownException, MultiThreadedExecutor\n',
            ),
            (
                "        super().__init__('arm_player')\n",
                "        super().__init__('arm_player')\n"
                '        self.threads = MultiThreadedExecutor()\n',
            ),
            ('complete(self, future)', 'complete(self, future, self.threads)'),
        ),
    ),
    Change(
        'waits_in_a_loop',
        swap(
            PLAYER,
            (
                '        self.solver.wait_for_service()\n',
                '        while not self.solver.wait_for_service(timeout_sec=1.0):\n'
                "            self.get_logger().info('no solver yet')\n",
            ),
        ),
    ),
    Change(
        'report_as_json',
        swap(
            PLAYER,
            ('import rclpy\n', 'import json\n\nimport rclpy\n'),
            ("' '.join(words)", 'json.dumps(words)'),
        ),
    ),
)


def _crlf(files: Files) -> None:
    """The files of an editor of Windows."""
    for name in files:
        files[name] = files[name].replace('\n', '\r\n')


def _as_created(files: Files) -> None:
    """What `ros2 pkg create` of Jazzy and an instruction on the web bring, with their TODOs."""
    files['test/test_copyright.py'] = 'from ament_copyright.main import main\n'
    files['launch/arm.launch.py'] = 'from launch import LaunchDescription\n'
    files['config/targets.yaml'] = '/arm_player:\n  ros__parameters:\n    targets: [1.2, 0.8]\n'
    files['README.md'] = files['LICENSE'] = 'TODO\n'
    swap(
        SETUP,
        (
            'from setuptools import setup\n',
            'import os\nfrom glob import glob\n\nfrom setuptools import find_packages, setup\n\n'
            "package_name = 'arm_player'\n",
        ),
        ("name='arm_player'", 'name=package_name'),
        ("packages=['arm_player']", "packages=find_packages(exclude=['test'])"),
        (
            "        ('share/arm_player', ['package.xml']),\n",
            "        (os.path.join('share', package_name), ['package.xml']),\n"
            "        (os.path.join('share', package_name, 'launch'), glob('launch/*.py')),\n"
            "        (os.path.join('share', package_name, 'config'), glob('config/*.yaml')),\n",
        ),
        ('student@example.com', 'root@todo.todo'),
        ('Apache-2.0', 'TODO: License declaration'),
    )(files)
    swap('package.xml', ('Apache-2.0', 'TODO: License declaration'))(files)


def _modules_alone(files: Files) -> None:
    """Both modules lie beside setup.py, in no Python package."""
    del files['arm_player/__init__.py']
    for name in DRIVER, PLAYER:
        files[name.removeprefix('arm_player/')] = files.pop(name)
    swap(
        SETUP,
        ("packages=['arm_player']", "py_modules=['arm_player', 'arm_driver']"),
        ('arm_player.arm_driver:main', 'arm_driver:main'),
        ('arm_player.arm_player:main', 'arm_player:main'),
    )(files)


def _folder_in_the_package(files: Files) -> None:
    files['arm_player/nodes/__init__.py'] = ''
    for name in DRIVER, PLAYER:
        files[name.replace('/', '/nodes/')] = files.pop(name)
    swap(
        SETUP,
        ("packages=['arm_player']", "packages=['arm_player', 'arm_player.nodes']"),
        ('= arm_player.', '= arm_player.nodes.'),
    )(files)


def _pyproject(files: Files) -> None:
    """The data of pyproject.toml, and a setup.py that only calls setup()."""
    files[SETUP] = 'from setuptools import setup\n\nsetup()\n'
    files['pyproject.toml'] = """[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"
[project]
name = "arm_player"
version = "0.1.0"
[project.scripts]
arm_driver = "arm_player.arm_driver:main"
arm_player = "arm_player.arm_player:main"
[tool.setuptools]
packages = ["arm_player"]
[tool.setuptools.data-files]
"share/ament_index/resource_index/packages" = ["resource/arm_player"]
"share/arm_player" = ["package.xml"]
"""


RIGHT += (
    *(
        Change(f'style_{name}', lambda files, text=text: files.update({PLAYER: text}))
        for name, text in STYLES.items()
    ),
    Change('crlf', _crlf),
    Change('as_created', _as_created),
    Change('modules_alone', _modules_alone),
    Change('folder_in_the_package', _folder_in_the_package),
    Change('pyproject', _pyproject),
)
