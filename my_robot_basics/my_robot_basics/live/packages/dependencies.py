"""Which ROS packages the code of a package imports, and its package.xml does not name."""

import ast
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from my_robot_basics.live.packages.package_faults import NO_PYTHON
from my_robot_basics.session.package_files import PackageFiles, first_clauses


def undeclared_dependencies(package: str, files: PackageFiles) -> tuple[str, ...]:
    """Return a clause with what to add for each such ROS package, in alphabetical order.

    The package.xml has to be valid. Only packages that are installed here count as ROS packages.
    """
    from ament_index_python import get_packages_with_prefixes

    named = _declared_dependencies(files.taken['package.xml'])
    ros_packages = get_packages_with_prefixes().keys() - named - {package}
    importing: dict[str, str] = {}
    for path, file in files.taken.items():
        if path.startswith(f'{package}/') and path.endswith('.py'):
            for name in _imported_names(file):
                importing.setdefault(name, path)
    clauses = (
        f'package.xml does not name {name}, which {importing[name]} imports: on a robot, colcon '
        f'and rosdep would not know that it is needed; add <depend>{name}</depend>'
        for name in sorted(ros_packages & importing.keys())
    )
    return first_clauses(list(clauses))


def _declared_dependencies(manifest: Path) -> set[str]:
    from catkin_pkg.package import parse_package_string

    parsed = parse_package_string(manifest.read_text(encoding='utf-8'))
    kinds = parsed.build_depends, parsed.exec_depends, parsed.buildtool_depends
    return {dependency.name for dependency in chain(*kinds)}


def _imported_names(file: Path) -> Iterator[str]:
    """Yield the first name of each absolute import in a file, also of those in functions."""
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, *NO_PYTHON):
        return  # the file that is run says so itself
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.split('.')[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.split('.')[0]
