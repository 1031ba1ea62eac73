"""Packages that students hand in for lesson 12: ours with a change, right, wrong and hostile."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

LESSON = '12_package'
SOURCE = Path(__file__).parents[1] / 'solutions' / LESSON / 'arm_player'
CHECKS = 'package_builds', 'package_runs', 'arm_player_plays'
FULL = 1, 2, 4

PLAYER, DRIVER, SETUP = 'arm_player/arm_player.py', 'arm_player/arm_driver.py', 'setup.py'
Files = dict[str, str]


def ours() -> Files:
    """The files of our own package, by their paths in its folder."""
    paths = (path for path in SOURCE.rglob('*') if path.is_file())
    texts = {str(p.relative_to(SOURCE)): p for p in paths if '__pycache__' not in p.parts}
    return {name: path.read_text(encoding='utf-8') for name, path in sorted(texts.items())}


def write(files: Files, folder: Path) -> None:
    """Write a package into a folder named `arm_player`, beside a notebook."""
    for name, text in files.items():
        (folder / 'arm_player' / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / 'arm_player' / name).write_text(text, encoding='utf-8')


@dataclass(frozen=True)
class Change:
    """What one student has done otherwise."""

    name: str
    make: Callable[[Files], None]
    points: tuple[float, ...] = FULL
    says: dict[str, str] = field(default_factory=dict)
    """What the reason for a check's lost points has to hold."""

    def files(self) -> Files:
        """The files of the package."""
        files = ours()
        self.make(files)
        return files


def swap(file: str, *pairs: tuple[str, str]) -> Callable[[Files], None]:
    """Replace texts in a file; each has to be there."""

    def make(files: Files) -> None:
        for old, new in pairs:
            if old not in files[file]:
                raise ValueError(f'{file} has no {old!r}')
            files[file] = files[file].replace(old, new)

    return make


def without(*names: str) -> Callable[[Files], None]:
    """Leave files out."""

    def make(files: Files) -> None:
        for name in names:
            del files[name]

    return make


# --- right, in unusual ways ----------------------------------------------------------------------


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
    # setup.py names the folder: Python imports it all the same, on a robot as well
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
    """Each target is visited from the callback of the one before: nothing ever waits."""
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


def _module_of_its_own(files: Files) -> None:
    """What the ends are called stands in a file beside the player."""
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

# --- wrong ---------------------------------------------------------------------------------------

NOTHING = 0, 0, 0
WRONG = (
    Change(
        'no_entry_point',
        swap(SETUP, ("            'arm_driver = arm_player.arm_driver:main',\n", '')),
        (0, 0, 4),
        {'package_builds': 'name arm_driver in entry_points', 'package_runs': 'arm_driver'},
    ),
    Change(
        'wrong_module',
        swap(SETUP, ('arm_player.arm_player:main', 'arm_player.player:main')),
        NOTHING,
        {'package_builds': 'player'},
    ),
    Change(
        'no_function_in_the_entry_point',
        swap(SETUP, ('arm_player.arm_player:main', 'arm_player.arm_player')),
        NOTHING,
        {'package_builds': 'write a colon and the function after the module'},
    ),
    Change(
        'no_marker_file', without('resource/arm_player'), NOTHING, {'package_builds': 'resource/'}
    ),
    Change('no_setup_cfg', without('setup.cfg'), NOTHING, {'package_builds': 'setup.cfg'}),
    Change('no_setup_py', without('setup.py'), NOTHING, {'package_builds': 'setup.py'}),
    Change('no_package_xml', without('package.xml'), NOTHING, {'package_builds': 'package.xml'}),
    Change(
        'no_clean_end',
        swap(
            DRIVER, ('except (KeyboardInterrupt, ExternalShutdownException)', 'except ValueError')
        ),
        (1, 0, 4),
        {'package_runs': 'catch KeyboardInterrupt'},
    ),
    Change(
        'shuts_down_once_too_often',
        swap(DRIVER, ('rclpy.try_shutdown()', 'rclpy.shutdown()')),
        (1, 0, 4),
        {'package_runs': 'catch KeyboardInterrupt.*try_shutdown'},
    ),
    Change(
        'stops_at_the_first_unreachable',
        swap(
            PLAYER,
            (
                'words = [self.visit(x, y) for x, y in targets]',
                'words = []\n        for x, y in targets:\n'
                '            words.append(self.visit(x, y))\n'
                "            if words[-1] == 'unreachable':\n                break",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'go on with the next target'},
    ),
    Change(
        'does_not_wait_for_the_arm',
        swap(PLAYER, ('        self.arm.wait_for_server()\n', '')),
        (1, 2, 0),
        {'arm_player_plays': 'wait for both servers first'},
    ),
    Change(
        'gives_up_after_a_second',
        swap(
            PLAYER,
            (
                'return ENDS[self.wait_for(goal_handle.get_result_async()).status]',
                'future = goal_handle.get_result_async()\n'
                '        rclpy.spin_until_future_complete(self, future, timeout_sec=1.0)\n'
                "        return ENDS[future.result().status] if future.result() else 'aborted'",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'when the result of the one before is there'},
    ),
    Change(
        'all_goals_at_once',
        swap(
            PLAYER,
            (
                'return ENDS[self.wait_for(goal_handle.get_result_async()).status]',
                "goal_handle.get_result_async()\n        return 'succeeded'",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'when the result of the one before is there'},
    ),
    Change(
        'reports_before_the_end',
        swap(
            PLAYER,
            (
                'numbers = self',
                "self.done.publish(String(data='succeeded'))\n        numbers = self",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'publish one report'},
    ),
    Change(
        'calls_in_a_callback',
        swap(
            PLAYER,
            ('        player.play()\n', '        player.create_timer(0.5, player.play)\n'),
            ('self.wait_for(self.solver.call_async(', '(self.solver.call('),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'inside a callback and waited there'},
    ),
    Change(
        'volatile',
        swap(PLAYER, ("'/arm_player/done', LATCHED", "'/arm_player/done', 10")),
        (1, 2, 0),
        {'arm_player_plays': 'TRANSIENT_LOCAL'},
    ),
    Change(
        'degrees',
        swap(DRIVER, ('[math.radians(angle) for angle in', '[angle for angle in')),
        (1, 0, 4),
        {'package_runs': 'radians'},
    ),
    Change(
        'elbow_down',
        swap(PLAYER, ('position=answer.elbow_up', 'position=answer.elbow_down')),
        (1, 2, 0),
        {'arm_player_plays': 'this is elbow_down: send response.elbow_up'},
    ),
    Change(
        'other_speed',
        swap(PLAYER, ('speed=0.5', 'speed=1.0')),
        (1, 2, 0),
        {'arm_player_plays': 'the speed that the task names'},
    ),
    Change(
        'swaps_x_and_y',
        swap(PLAYER, ('Point(x=x, y=y)', 'Point(x=y, y=x)')),
        (1, 0, 0),
        {'package_runs': 'put x and y into', 'arm_player_plays': 'put x and y into'},
    ),
    Change(
        'other_parameter',
        swap(
            PLAYER,
            ("declare_parameter('targets'", "declare_parameter('points'"),
            ("get_parameter('targets')", "get_parameter('points')"),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'targets'},
    ),
    Change(
        'last_one_first',
        swap(PLAYER, ('for x, y in targets]', 'for x, y in [*targets][::-1]]')),
        (1, 2, 0),
        {'arm_player_plays': 'target'},
    ),
    Change(
        'takes_rejected_ones_for_accepted',
        swap(
            PLAYER,
            ("        if not goal_handle.accepted:\n            return 'rejected'\n", ''),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'KeyError|not accepted'},
    ),
    Change(
        'numbers_for_words',
        swap(
            PLAYER,
            (
                'return ENDS[self.wait_for(goal_handle.get_result_async()).status]',
                'return str(self.wait_for(goal_handle.get_result_async()).status)',
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'write the word for each status, and not its number'},
    ),
    Change(
        'two_ls',
        swap(PLAYER, ("STATUS_CANCELED: 'canceled'", "STATUS_CANCELED: 'cancelled'")),
        (1, 2, 0),
        {'arm_player_plays': 'write the words as the task does'},
    ),
    Change(
        'other_topic',
        swap(PLAYER, ("'/arm_player/done'", "'/arm_player/finished'")),
        (1, 2, 0),
        {'arm_player_plays': 'the report'},
    ),
    Change(
        'asks_nobody',
        swap(
            PLAYER,
            ('self.solver = self.create_client(SolveIK, ', 'self.solver = str('),
            ('        self.solver.wait_for_service()\n', ''),
            (
                'self.wait_for(self.solver.call_async(SolveIK.Request(target=Point(x=x, y=y))))',
                'SolveIK.Response(reachable=True, elbow_up=[x, y])',
            ),
        ),
        (1, 0, 0),
        {'package_runs': '/solve_ik', 'arm_player_plays': '/solve_ik'},
    ),
    Change(
        'other_node_name',
        swap(DRIVER, ("super().__init__('arm_driver')", "super().__init__('driver')")),
        (1, 0, 4),
        {'package_runs': r'look at super\(\).__init__'},
    ),
    Change(
        'goes_on_after_ctrl_c',
        swap(
            DRIVER,
            ('        rclpy.init()\n', '        rclpy.init(signal_handler_options=NO)\n'),
            (
                '        rclpy.spin(ArmDriver())\n',
                '        driver = ArmDriver()\n        while True:\n            try:\n'
                '                rclpy.spin(driver)\n            except KeyboardInterrupt:\n'
                "                print('not now')\n",
            ),
            (
                'from rclpy.node import Node\n',
                'from rclpy.node import Node\nfrom rclpy.signals import SignalHandlerOptions\n',
            ),
            ('class ArmDriver', 'NO = SignalHandlerOptions.NO\n\n\nclass ArmDriver'),
        ),
        (1, 0, 4),
        {'package_runs': 'it still runs after'},
    ),
)


def _scripts_for_entry_points(files: Files) -> None:
    """Programs of setuptools' other kind, which colcon's build leaves as for a wheel."""
    head, rest = files[SETUP].split('    entry_points={')
    names = 'arm_driver', 'arm_player'
    scripts = [f'scripts/{name}' for name in names]
    files[SETUP] = f'{head}    scripts={scripts},\n' + rest.split('    },\n', maxsplit=1)[1]
    for name, script in zip(names, scripts, strict=True):
        files[script] = f'#!/usr/bin/env python3\nfrom arm_player.{name} import main\n\nmain()\n'


def _finds_no_package(files: Files) -> None:
    """setup.py looks for folders with an __init__.py, and there is none."""
    without('arm_player/__init__.py')(files)
    swap(
        SETUP,
        ('import setup\n', 'import find_packages, setup\n'),
        ("packages=['arm_player']", 'packages=find_packages()'),
    )(files)


WRONG += (
    Change('finds_no_package', _finds_no_package, NOTHING, {'package_builds': '__init__'}),
    Change(
        'scripts_for_entry_points',
        _scripts_for_entry_points,
        NOTHING,
        {'package_builds': 'name a function in entry_points of setup.py'},
    ),
)

# --- hostile -------------------------------------------------------------------------------------


def _shell_script(files: Files) -> None:
    """`lib/arm_player/arm_driver` is a script that does nothing, and never ends."""
    files['scripts/arm_driver'] = '#!/bin/sh\ntrap "" INT TERM\nwhile :; do sleep 1; done\n'
    swap(
        SETUP,
        ("            'arm_driver = arm_player.arm_driver:main',\n", ''),
        ('data_files=[', "data_files=[\n        ('lib/arm_player', ['scripts/arm_driver']),"),
    )(files)


_STARTS_IT = """import os, sys
if os.fork() == 0:
    os.setsid()
    sys.path.insert(0, os.getcwd())
    from arm_player.arm_node import main
    main()
    os._exit(0)
"""


def _setup_starts_a_node(files: Files) -> None:
    """The driver runs from the build on, and holds colcon's pipe; the executable only waits."""
    files['arm_player/arm_node.py'] = files[DRIVER]
    files[DRIVER] = 'import time\n\n\ndef main():\n    time.sleep(600)\n'
    files[SETUP] = f'{_STARTS_IT}{files[SETUP]}'


_ITS_OWN_SERVERS = """
        from arm_player.arm_driver import ArmDriver
        import threading
        driver = ArmDriver()
        threading.Thread(target=rclpy.spin, args=(driver,), daemon=True).start()
        player.play()
"""

HOSTILE = (
    Change('shell_script', _shell_script, (0, 0, 4)),
    Change(
        'setup_starts_a_node', _setup_starts_a_node, (1, 0, 4), {'package_runs': '/arm_driver'}
    ),
    Change(
        'player_serves_itself',
        swap(PLAYER, ('        player.play()\n', _ITS_OWN_SERVERS.removeprefix('\n'))),
        (1, 0, 0),
        {'package_runs': '/solve_ik', 'arm_player_plays': '/solve_ik'},
    ),
    Change(
        'player_reports_what_it_was_not_told',
        swap(
            PLAYER,
            (
                "        self.done.publish(String(data=' '.join(words)))",
                "        self.done.publish(String(data='succeeded ' * len(words)))",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'the status of the result tells how it ended'},
    ),
)
ALL = (*RIGHT, *WRONG, *HOSTILE)
