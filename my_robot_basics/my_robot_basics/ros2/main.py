"""The console script `ros2`: runs a real ros2cli if there is one, else a verb of the table."""

import argparse
import io
import os
import sys
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from my_robot_basics.ros2 import environment, stopping
from my_robot_basics.ros2.errors import Stopped
from my_robot_basics.ros2.table import COMMANDS, ELSEWHERE, Command

PIPE_CLOSED = 128 + 13
"""The exit status that a shell reports for a process that SIGPIPE ended."""
USAGE = 2


def main(argv: list[str] | None = None) -> int | str | None:
    """Run the command, and return what `sys.exit` takes: a status, or a text for stderr."""
    if find_spec('ros2cli'):
        from ros2cli.cli import main as real_main

        return real_main(argv=argv)
    stopping.set_handlers()
    sys.stdout = sys.stdout or open(os.devnull, 'w')  # noqa: SIM115 - where a shell closed it
    words = sys.argv[1:] if argv is None else argv
    if sentence := ros2cli_only_message(words):
        print(sentence, file=sys.stderr)
        return USAGE
    parser = make_parser(words)
    if '_ARGCOMPLETE' in os.environ:
        from argcomplete import autocomplete

        environment.enter()
        autocomplete(parser, exclude=['-h', '--help'])
    try:
        return _run(parser.parse_args(words))
    except BrokenPipeError:
        # discard what is still in the buffer: flushing it at exit would raise again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED


def ros2cli_only_message(words: list[str]) -> str | None:
    """Return a sentence about a command or verb that only ros2cli has, or None."""
    command, verb = _chosen(words)
    if command in ELSEWHERE:
        missing, package = f'ros2 {command}', f'ros2{command}'
    elif command in COMMANDS and verb in COMMANDS[command].elsewhere:
        missing, package = f'ros2 {command} {verb}', f'ros2{command}'
    else:
        return None
    return (
        f'`{missing}` is not part of this course: it comes with a ROS 2 installation, in the '
        f'package {package} of ros2cli (ROS 2 Jazzy); see '
        'https://docs.ros.org/en/jazzy/Installation.html'
    )


def make_parser(words: list[str]) -> argparse.ArgumentParser:
    """Return the parser for a command line; only verbs that it may use are imported."""
    chosen, chosen_verb = _chosen(words)
    if '_ARGCOMPLETE' in os.environ:
        chosen, chosen_verb = None, None
    parser = argparse.ArgumentParser(
        'ros2',
        description='ros2 is an extensible command-line tool for ROS 2.',
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        '--use-python-default-buffering',
        action='store_true',
        help='Do not force line buffering in stdout',
    )
    parser.set_defaults(help_of=parser)
    commands = _add_choices(parser, 'ros2', {n: c.description for n, c in COMMANDS.items()})
    for name, command in COMMANDS.items():
        command_parser = _add_parser(commands, name, command.description)
        if chosen not in (name, None):
            continue
        if not command.verbs:
            _add_verb(command_parser, _module(name))
            continue
        if command.hidden_flag:
            command_parser.add_argument(
                command.hidden_flag,
                action='store_true',
                help=f'Consider hidden {name}s as well',
            )
        _add_verbs(command_parser, name, command, chosen_verb)
    return parser


def _add_verbs(
    parser: argparse.ArgumentParser, name: str, command: Command, chosen: str | None
) -> None:
    parser.set_defaults(help_of=parser)
    wanted = [chosen] if chosen in command.verbs else command.verbs
    modules = {verb: _module(f'{name}_{verb}') for verb in wanted}
    descriptions = {verb: _description(module) for verb, module in modules.items()}
    verbs = _add_choices(parser, f'ros2 {name}', descriptions)
    for verb, module in modules.items():
        _add_verb(_add_parser(verbs, verb, descriptions[verb]), module)


def _add_verb(parser: argparse.ArgumentParser, module: ModuleType) -> None:
    parser.set_defaults(main=module.main)
    module.add_arguments(parser)


def _add_choices(
    parser: argparse.ArgumentParser, name: str, descriptions: dict[str, str]
) -> argparse._SubParsersAction:
    width = max(len(word) for word in descriptions)
    lines = [f'{word.ljust(width)}  {text}' for word, text in descriptions.items()]
    return parser.add_subparsers(
        title='Commands',
        description='\n'.join(lines),
        metavar=f'Call `{name} <command> -h` for more detailed usage.',
    )


def _add_parser(
    choices: argparse._SubParsersAction, name: str, description: str
) -> argparse.ArgumentParser:
    return choices.add_parser(
        name,
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def _run(args: argparse.Namespace) -> int | str | None:
    if isinstance(sys.stdout, io.TextIOWrapper):
        if not args.use_python_default_buffering:
            sys.stdout.reconfigure(line_buffering=True)
        sys.stdout.reconfigure(errors='backslashreplace')
    if not hasattr(args, 'main'):
        args.help_of.print_help()
        return 0
    environment.enter()
    try:
        status = args.main(args)
    except Stopped as stopped:
        status = stopped.number
    except RuntimeError as error:  # a CommandError, or an error of DDS that rclpy reports
        status = str(error)
    sys.stdout.flush()
    stopping.cancel_alarm()
    return status


def _chosen(words: list[str]) -> tuple[str | None, str | None]:
    """Return the command and the verb: no option that may come before them takes a value."""
    plain = [word for word in words if not word.startswith('-')]
    command, verb, *_ = (*plain, None, None)
    return command, verb


def _module(name: str) -> ModuleType:
    return import_module(f'my_robot_basics.ros2.verbs.{name}')


def _description(module: ModuleType) -> str:
    return (module.__doc__ or '').partition('\n')[0].rstrip('.')
