"""Packages that students hand in for lesson 12: ours with a change, right, wrong and hostile."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

SOURCE = Path(__file__).parents[1] / 'solutions/12_package/arm_player'
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
    Change(
        'commas_and_a_log',
        swap(
            PLAYER,
            ("' '.join(words)", "', '.join(words)"),
            ('numbers = ', "print('hi'); numbers = "),
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


HOSTILE = (Change('shell_script', _shell_script, (0, 0, 4)),)
ALL = (*RIGHT, *WRONG, *HOSTILE)
