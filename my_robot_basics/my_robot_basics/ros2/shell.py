"""`./course ros-shell`: a shell with ROS's environment, in the ROS domain of a lesson."""

import os
import sys
import time
from pathlib import Path

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.ros2 import environment
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session import classroom, lessons
from my_robot_basics.session.arguments import Arguments

STARTUP = Path(__file__).with_name('terminal.bash')
SHOWN = (
    *('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_WS', 'AMENT_PREFIX_PATH'),
    'FASTRTPS_DEFAULT_PROFILES_FILE',
)
USAGE = 2


def main(argv: list[str] | None = None) -> int:
    """Set the environment, report it on stderr, and exec a shell or the given command."""
    args = _parser().parse_args(argv)
    running = lessons.running()
    try:
        domain_id = _choose(running, args.lesson)
    except CommandError as error:
        print(f'course: {in_language_here(str(error))}', file=sys.stderr)
        return USAGE
    os.environ['ROS_DOMAIN_ID'] = str(domain_id)
    os.environ['ROS_WS'] = str(classroom.workspace())
    environment.enter()
    _leave_python()
    print(_report(running, domain_id), file=sys.stderr)
    if args.script is not None:
        command = ['bash', '-c', args.script]
    else:
        command = args.command or ['bash', '--rcfile', str(STARTUP), '-i']
    try:
        os.execvp(command[0], command)
    except OSError as error:
        said = in_language_here(f'{command[0]} does not start: {error.strerror}')
        print(f'course: {said}', file=sys.stderr)
        return 127 if isinstance(error, FileNotFoundError) else 126


def _parser() -> Arguments:
    parser = Arguments(
        './course ros-shell',
        description=in_language_here('Open a shell in which ROS is set up, and say what was set.'),
        usage='%(prog)s [--lesson LESSON] [-c SCRIPT | -- COMMAND ...]',
    )
    parser.add_argument(
        '--lesson',
        help=in_language_here(
            'the lesson to join, by its name (or how that begins) or its ROS domain ID; else the '
            'one that started last'
        ),
    )
    about = in_language_here('run this in bash, instead of an open shell')
    parser.add_argument('-c', dest='script', help=about)
    about = in_language_here('run this command, instead of a shell')
    parser.add_argument('command', nargs='*', help=about)
    return parser


def _choose(running: list[lessons.RunningLesson], wanted: str | None) -> int:
    """Return the domain of the chosen lesson; 0, which is ROS's default, if no lesson runs."""
    if wanted is None:
        return running[-1].domain_id if running else 0
    # a number is a domain, but 03 is the beginning of a lesson's name
    if wanted in map(str, range(classroom.HIGHEST_DOMAIN + 1)):
        return int(wanted)
    named = [lesson for lesson in running if lesson.name.startswith(wanted)]
    if named:
        return named[-1].domain_id
    names = ', '.join(lesson.name for lesson in running) or 'none'
    raise CommandError(
        f'--lesson is {wanted!r}, expected one of the lessons that are running ({names}): '
        'run the first cell of that lesson, or leave the option out'
    )


def _report(running: list[lessons.RunningLesson], domain_id: int) -> str:
    lines = []
    for lesson in running:
        started = time.strftime('%H:%M:%S', time.localtime(lesson.started_nsec / 1e9))
        mark = 'joined' if lesson.domain_id == domain_id else ''
        joined = f'  <- {in_language_here(mark)}' if mark else ''
        where = in_language_here(f'in ROS domain {lesson.domain_id}, {started}')
        lines.append(f'  {lesson.name:20} {where}{joined}')
    if lines:
        lines.insert(0, in_language_here('lessons that are running:'))
    else:
        lines = [in_language_here('no lesson is running')]
    lines += [f'{name}={os.environ[name]}' for name in SHOWN]
    folder = os.environ['PATH'].partition(os.pathsep)[0]
    lines.append(in_language_here(f'PATH begins with {folder}'))
    if not classroom.workspace().is_dir():
        lines.append(in_language_here('there is no workspace yet: ./course workspace makes it'))
    return '\n'.join(lines)


def _leave_python() -> None:
    """Unset variables that ROS's wheels have set for this process; each Python sets its own."""
    folders = os.environ.pop('LD_LIBRARY_PATH', '').split(os.pathsep)
    kept = [folder for folder in folders if folder and not folder.startswith(f'{sys.prefix}/')]
    if kept:
        os.environ['LD_LIBRARY_PATH'] = os.pathsep.join(kept)
    os.environ.pop('_ROS_WHEELS_BOOTSTRAP_COMPLETE', None)


if __name__ == '__main__':
    sys.exit(main())
