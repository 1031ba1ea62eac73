"""Output a list of packages that provide interfaces."""

import argparse

from my_robot_basics.ros2 import interfaces


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    kinds = {'msg': 'messages', 'srv': 'services', 'action': 'actions'}
    for kind, text in kinds.items():
        parser.add_argument(
            f'-{kind[0]}',
            f'--only-{kind}s',
            action='store_true',
            help=f'Only list packages that generate {text}',
        )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    # of several options, ros2cli uses only the first one
    chosen = [kind for kind in interfaces.KINDS if getattr(args, f'only_{kind}s')][:1]
    for name in interfaces.packages(*chosen):
        print(name)
