"""Packages for lesson 12 with one mistake each, and hostile ones."""

from collections.abc import Callable

from package_changes import CHECKS, DRIVER, PLAYER, SETUP, Change, Files, swap, without
from player_styles import STYLES

NOTHING = 0, 0, 0
_FEEDBACK = (
    '        goal_handle.publish_feedback'
    '(MoveArm.Feedback(position=self.position, remaining=left))\n'
)
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
        'async_main',
        swap(PLAYER, ('def main', 'async def main')),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), 'def main without async'),
    ),
    Change(
        'parameter_without_value',
        swap(PLAYER, ("get_parameter('targets').value", "get_parameter('targets')")),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), 'so get its value'),
    ),
    Change(
        'result_without_spinning',
        swap(
            PLAYER,
            (
                '        rclpy.spin_until_future_complete(self, future)\n'
                '        if not future.done():\n            raise ExternalShutdownException\n',
                '',
            ),
        ),
        (1, 0, 0),
        {'package_runs': "'NoneType' object", 'arm_player_plays': "'NoneType' object"},
    ),
    Change(
        'no_marker_file', without('resource/arm_player'), NOTHING, {'package_builds': 'resource/'}
    ),
    Change(
        'no_setup_cfg',
        without('setup.cfg'),
        NOTHING,
        dict.fromkeys(CHECKS, 'are in bin/.*setup.cfg'),
    ),
    Change(
        'setup_cfg_of_another_package',
        swap('setup.cfg', ('lib/arm_player', 'lib/hello_arm')),
        NOTHING,
        dict.fromkeys(CHECKS, 'are in lib/hello_arm/.*setup.cfg'),
    ),
    Change(
        'no_comma_between_entry_points',
        swap(SETUP, ("arm_driver:main',", "arm_driver:main'")),
        NOTHING,
        dict.fromkeys(CHECKS, 'without a comma between them'),
    ),
    Change(
        'entry_point_with_py',
        swap(SETUP, ('arm_player.arm_player:main', 'arm_player.arm_player.py:main')),
        NOTHING,
        {'package_builds': 'leave out .py'},
    ),
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
        'does_not_wait_for_the_solver',
        swap(PLAYER, ('        self.solver.wait_for_service()\n', '')),
        (1, 2, 0),
        {'arm_player_plays': 'wait until there is a server'},
    ),
    Change(
        'driver_rejects_nothing',
        swap(DRIVER, ("'goal_callback': self.judge, ", '')),
        (1, 0, 4),
        {'package_runs': 'a second goal is accepted'},
    ),
    Change(
        'driver_rejects_no_second_goal',
        swap(DRIVER, ('if self.is_moving or len', 'if len')),
        (1, 0, 4),
        {'package_runs': 'remember that the arm moves'},
    ),
    Change(
        'driver_gives_no_feedback',
        swap(DRIVER, (_FEEDBACK, '')),
        (1, 0, 4),
        {'package_runs': 'publish_feedback'},
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
        'leaves_out_the_last',
        swap(PLAYER, ('numbers[::2], numbers[1::2]', 'numbers[:-2:2], numbers[1:-2:2]')),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), 'go on until the last target'),
    ),
    Change(
        'visits_each_point_once',
        swap(
            PLAYER,
            ('targets = zip(', 'targets = dict.fromkeys(zip('),
            ('strict=True)\n', 'strict=True))\n'),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'also one that you have visited before'},
    ),
    Change(
        'reports_twice',
        swap(
            PLAYER,
            (
                "self.done.publish(String(data=' '.join(words)))",
                "report = String(data=' '.join(words))\n        self.done.publish(report)\n"
                '        self.done.publish(report)',
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'publish the report once'},
    ),
    Change(
        'no_clean_end_after_the_report',
        swap(
            PLAYER,
            ('        rclpy.spin(player)  # the report stays available\n', ''),
            (
                '    finally:\n        rclpy.try_shutdown()',
                '    rclpy.spin(player)\n    rclpy.try_shutdown()',
            ),
        ),
        (1, 0, 4),
        {'package_runs': 'catch KeyboardInterrupt'},
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
        {
            'package_runs': 'copy both to the request',
            'arm_player_plays': 'copy both to the request',
        },
    ),
    Change(
        'other_parameter',
        swap(
            PLAYER,
            ("declare_parameter('targets'", "declare_parameter('points'"),
            ("get_parameter('targets')", "get_parameter('points')"),
        ),
        (1, 0, 0),
        {'package_runs': 'the parameter targets', 'arm_player_plays': 'the parameter targets'},
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
        {'arm_player_plays': 'uses /arm_player/finished, so compare the spelling'},
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
        'handles_sigint_itself',
        swap(
            DRIVER,
            ('import math\n', 'import math\nimport signal\n'),
            (
                '        rclpy.init()\n',
                '        rclpy.init()\n'
                '        signal.signal(signal.SIGINT, lambda *_: rclpy.shutdown())\n',
            ),
        ),
        (1, 0, 4),
        {'package_runs': r'leave SIGINT to rclpy.init\(\), without signal.signal'},
    ),
    Change(
        'waits_in_call',
        swap(
            PLAYER,
            ('import rclpy\n', 'import time\n\nimport rclpy\n'),
            (
                'import ExternalShutdownException\n',
                'import ExternalShutdownException, MultiThreadedExecutor\n',
            ),
            (
                'self.wait_for(self.solver.call_async(SolveIK.Request(target=Point(x=x, y=y))))',
                'self.solver.call(SolveIK.Request(target=Point(x=x, y=y)))',
            ),
            (
                '        rclpy.spin_until_future_complete(self, future)\n'
                '        if not future.done():\n            raise ExternalShutdownException\n',
                '        while not future.done():\n            time.sleep(0.01)\n',
            ),
            ('    def play(self):\n', '    def play(self):\n        self.begin.cancel()\n'),
            (
                '        player.play()\n        rclpy.spin(player)',
                '        group = rclpy.callback_groups.ReentrantCallbackGroup()\n'
                '        player.begin = player.create_timer(0.1, player.play, group)\n'
                '        rclpy.spin(player, MultiThreadedExecutor())',
            ),
        ),
        (1, 0, 4),
        {'package_runs': r'client\.call\(…\) waits for a response, and after Ctrl-C none comes'},
    ),
    Change(
        'declares_no_numbers',
        swap(PLAYER, ("'targets', [1.2, 0.8, 0.9, -0.9]", "'targets', []")),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), 'so declare it with doubles'),
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
    """setuptools' `scripts` instead of entry points; colcon's build leaves them as in a wheel."""
    head, rest = files[SETUP].split('    entry_points={')
    names = 'arm_driver', 'arm_player'
    scripts = [f'scripts/{name}' for name in names]
    files[SETUP] = f'{head}    scripts={scripts},\n' + rest.split('    },\n', maxsplit=1)[1]
    for name, script in zip(names, scripts, strict=True):
        files[script] = f'#!/usr/bin/env python3\nfrom arm_player.{name} import main\n\nmain()\n'


def _finds_no_package(files: Files) -> None:
    """setup.py searches for folders with an __init__.py, but there is none."""
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


WRONG += (
    Change(
        'asks_for_each_point_once',
        swap(
            PLAYER,
            (
                "        super().__init__('arm_player')\n",
                "        super().__init__('arm_player')\n        self.answers = {}\n",
            ),
            (
                'answer = self.wait_for(self.solver.call_async('
                'SolveIK.Request(target=Point(x=x, y=y))))\n',
                'if (x, y) not in self.answers:\n'
                '            asked = SolveIK.Request(target=Point(x=x, y=y))\n'
                '            self.answers[x, y] = self.wait_for(self.solver.call_async(asked))\n'
                '        answer = self.answers[x, y]\n',
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'ask for each target of the list'},
    ),
    Change(
        'sends_a_goal_for_an_unreachable_target',
        swap(
            PLAYER,
            (
                "            return 'unreachable'\n",
                '            home = MoveArm.Goal(position=[0.0, 0.0], speed=0.5)\n'
                '            self.wait_for(self.arm.send_goal_async(home))\n'
                "            return 'unreachable'\n",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'send no goal if response.reachable is False'},
    ),
    Change(
        'waits_for_a_second_at_most',
        swap(
            PLAYER,
            ('self.solver.wait_for_service()', 'self.solver.wait_for_service(timeout_sec=1.0)'),
            ('self.arm.wait_for_server()', 'self.arm.wait_for_server(timeout_sec=1.0)'),
        ),
        (1, 2, 0),
        {'arm_player_plays': r'wait until there is a server|wait for both servers first'},
    ),
    Change(
        'sees_for_itself_what_is_reachable',
        swap(PLAYER, ('if not answer.reachable', 'if not 0.2 <= (x * x + y * y) ** 0.5 <= 1.8')),
        (1, 2, 0),
        {'arm_player_plays': 'if response.reachable is False'},
    ),
    Change(
        'tries_a_canceled_goal_again',
        swap(
            PLAYER,
            (
                'return ENDS[self.wait_for(goal_handle.get_result_async()).status]',
                'word = ENDS[self.wait_for(goal_handle.get_result_async()).status]\n'
                "        return self.visit(x, y) if word == 'canceled' else word",
            ),
        ),
        (1, 2, 0),
        {'arm_player_plays': 'note its status and go on'},
    ),
)

WRONG += (
    Change(
        'ends_soon_after_the_report',
        swap(
            PLAYER,
            ('import rclpy\n', 'import time\n\nimport rclpy\n'),
            (
                '        rclpy.spin(player)  # the report stays available',
                '        time.sleep(1.5)',
            ),
        ),
        (1, 0, 0),
        dict.fromkeys(
            ('package_runs', 'arm_player_plays'), 'arm_player ends by itself: main has returned'
        ),
    ),
    Change(
        'words_without_spaces',
        swap(PLAYER, ("' '.join(words)", "''.join(words)")),
        (1, 2, 0),
        {'arm_player_plays': 'write these words alone, with a space between'},
    ),
    Change(
        'numbers_its_words',
        swap(PLAYER, ("' '.join(words)", "' '.join(f'{n}:{w}' for n, w in enumerate(words, 1))")),
        (1, 2, 0),
        {'arm_player_plays': 'write these words alone, with a space between'},
    ),
)

_NO_NUMBER = """        if request.target.x != request.target.x:
            response.reachable = True
            return response
"""
_BELOW = """        if request.target.y < 0.0:
            response.message = 'below the table'
            return response
"""
_SOLVES = '        try:\n            solutions'
_IN_DEGREES = (
    '        joint1, joint2 = (math.degrees(angle) for angle in goal.position)\n'
    '        if not (abs(joint1) <= 90.0 and abs(joint2) <= 120.0 and'
)
_IN_RADIANS = (
    '        joint1, joint2 = goal.position\n'
    '        if not (abs(joint1) <= 1.5 and abs(joint2) <= 2.0 and'
)

WRONG += tuple(
    Change(f'driver_{name}', swap(DRIVER, pair), (1, 0, 4), {'package_runs': says})
    for name, pair, says in (
        ('takes_no_speed', ('goal.speed > 0.0', 'goal.speed >= 0.0'), 'speed is not above 0'),
        ('rounds_the_limits', (_IN_DEGREES, _IN_RADIANS), 'accepted|limit'),
        ('reaches_nan', (_SOLVES, _NO_NUMBER + _SOLVES), 'NaN is called reachable'),
        ('reaches_nothing_below', (_SOLVES, _BELOW + _SOLVES), 'within reach is called unreach'),
        ('has_one_speed', ('/ goal_handle.request.speed', '/ 0.1'), 'speed'),
        (
            'minds_z',
            (
                'inverse_kinematics(request.target.x, request.target.y)',
                'inverse_kinematics(request.target.x, request.target.y + request.target.z)',
            ),
            'elbow_up is wrong|z does not matter|called unreachable',
        ),
    )
)


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
    """The build starts the driver, which holds colcon's pipe; the executable only waits."""
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


def _one_folder_too_deep(files: Files) -> None:
    for name in [*files]:
        files[f'arm_player/{name}'] = files.pop(name)


def _player(style: str, *pairs: tuple[str, str]) -> Callable[[Files], None]:
    """Return a change to another style of the player, with texts replaced."""

    def make(files: Files) -> None:
        files[PLAYER] = STYLES[style]
        swap(PLAYER, *pairs)(files)

    return make


_TRY = '        rclpy.try_shutdown()\n'

WRONG += (
    Change(
        'one_folder_too_deep',
        _one_folder_too_deep,
        NOTHING,
        dict.fromkeys(CHECKS, 'package.xml is in arm_player/arm_player/'),
    ),
    Change(
        'entry_point_without_the_package',
        swap(SETUP, ('= arm_player.arm_driver:main', '= arm_driver:main')),
        (0, 0, 4),
        {'package_builds': 'is in the package arm_player: write arm_player.arm_driver:main'},
    ),
    Change(
        'awaits_in_the_default_group',
        _player('awaits', ('= ReentrantCallbackGroup()', '= None')),
        (1, 2, 0),
        {'arm_player_plays': 'or `await` with the callback and the client in one Reentrant'},
    ),
    Change(
        'main_returns_the_node',
        _player('tutorial', ('        rclpy.try_shutdown()', _TRY + '    return node')),
        (1, 0, 4),
        {'package_runs': 'exit code 1, <arm_player.*main returns something'},
    ),
    Change(
        'reads_its_arguments_itself',
        swap(
            PLAYER,
            (
                '        rclpy.init()',
                '        ArgumentParser().parse_args()\n        rclpy.init()',
            ),
            ('import rclpy\n', 'from argparse import ArgumentParser\n\nimport rclpy\n'),
        ),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), r'so write parse_known_args\(\)'),
    ),
    Change(
        'no_await_before_a_method',
        _player('awaits', ('word = await self.visit', 'word = self.visit')),
        (1, 0, 0),
        dict.fromkeys(('package_runs', 'arm_player_plays'), 'so put `await` before the call'),
    ),
    Change(
        'no_await_before_the_result',
        _player('awaits', ('result = await handle', 'result = handle')),
        (1, 2, 0),
        {'arm_player_plays': 'or with `await` in a coroutine'},
    ),
    Change(
        'gives_words_of_its_own',
        _player('awaits', ("return 'aborted'", "return 'failed'")),
        (1, 2, 0),
        {'arm_player_plays': 'write these words alone'},
    ),
)
