"""Output a list of available packages."""

import argparse

from my_robot_basics.ros2 import packages


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments: none."""


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    for name in packages.names():
        print(name)
