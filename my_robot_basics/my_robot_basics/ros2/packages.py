"""Packages and their executables from the ament index, of workspaces and of this Python."""

import os
from pathlib import Path

from my_robot_basics.ros2.errors import CommandError


def names() -> list[str]:
    """Return the names of all packages, sorted."""
    from ament_index_python import get_packages_with_prefixes

    return sorted(get_packages_with_prefixes())


def prefix(package_name: str) -> Path | None:
    """Return the first prefix in AMENT_PREFIX_PATH with the package, or None."""
    from ament_index_python import PackageNotFoundError, get_package_prefix

    try:
        return Path(get_package_prefix(package_name))
    except (PackageNotFoundError, ValueError):
        return None


def executables(package_name: str) -> list[Path]:
    """Return a package's executables, sorted by path; raises CommandError if it is missing."""
    if (found := prefix(package_name)) is None:
        raise CommandError(f"Package '{package_name}' not found")
    paths: list[Path] = []
    for folder, folders, files in os.walk(found / 'lib' / package_name):
        folders[:] = [name for name in folders if not name.startswith('.')]
        candidates = (Path(folder, name) for name in files)
        paths.extend(path for path in candidates if os.access(path, os.X_OK))
    return sorted(paths)
