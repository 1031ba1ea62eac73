"""The workspaces that a terminal has sourced, and what is wrong with the packages in them."""

import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from my_robot_basics.session.overlays import INDEX, LAYOUT, Overlay, gone


def sourced(variables: Mapping[str, str]) -> Iterator[Overlay]:
    """Yield the packages of interfaces in the workspaces that a terminal has sourced."""
    for prefix in _prefixes(variables):
        if any(os.path.isfile(folder / LAYOUT) for folder in (prefix, prefix.parent)):
            yield from (Overlay(prefix, file.name) for file in sorted(prefix.glob(f'{INDEX}/*')))


def faults(variables: Mapping[str, str]) -> Iterator[str]:
    """Yield a sentence for each fault of the workspaces that a terminal has sourced."""
    yield from (
        gone(prefix) for prefix in _prefixes(variables) if not os.access(prefix, os.R_OK | os.X_OK)
    )
    for overlay in sourced(variables):
        if sentence := overlay.fault() or overlay.difference():
            yield sentence


def _prefixes(variables: Mapping[str, str]) -> Iterator[Path]:
    for folder in variables.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if folder and folder != sys.prefix:
            yield Path(folder)
