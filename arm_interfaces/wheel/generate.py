"""What rosidl makes of the package's .srv and .action files: C, C++ and Python.

The same as `rosidl_generate_interfaces` in a colcon build, without CMake.
"""

import json
from collections.abc import Callable
from pathlib import Path

from ament_index_python import get_package_share_directory
from rosidl_adapter import convert_to_idl
from rosidl_cli.command.helpers import generate_visibility_control_file
from rosidl_generator_c import generate_c
from rosidl_generator_py.generate_py_impl import generate_py
from rosidl_generator_type_description import generate_type_hash
from rosidl_typesupport_c import generate_c as generate_typesupport_c
from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
from rosidl_typesupport_introspection_c import generate_c as generate_introspection_c

PACKAGE = 'arm_interfaces'
TYPE_PACKAGES = (
    'action_msgs',
    'builtin_interfaces',
    'geometry_msgs',
    'service_msgs',
    'unique_identifier_msgs',
)
"""Packages whose types stand in ours, or in what services and actions consist of."""
TYPE_SUPPORTS = ['rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_introspection_c']
"""What rmw_fastrtps_cpp asks rosidl_typesupport_c for."""
INTROSPECTION = 'introspection'
"""A folder of its own: its files have the names of rosidl_generator_c's."""


def interface_files(source: Path) -> list[Path]:
    """Paths of the .srv and .action files in a package's folder, relative to it, sorted."""
    files = [*source.glob('srv/*.srv'), *source.glob('action/*.action')]
    return sorted(file.relative_to(source) for file in files)


def generate(source: Path, target: Path) -> None:
    """Write all into a folder: arm_interfaces/srv/_solve_ik.py and so on.

    What rosidl_typesupport_introspection_c makes lies beside arm_interfaces/.
    """
    output = target / PACKAGE
    files = interface_files(source)
    idl = [file.with_suffix('.idl') for file in files]
    for file in files:
        convert_to_idl(source, PACKAGE, file, output)

    def run(generator: Callable, of: str, *arguments: list[str], **more: list[str] | str) -> None:
        templates = Path(get_package_share_directory(of), 'resource')
        order = target / f'{of}.json'
        content = {
            'package_name': PACKAGE,
            'output_dir': str(output),
            'template_dir': str(templates),
            'idl_tuples': [f'{output}:{file}' for file in idl],
            'target_dependencies': [],
        }
        order.write_text(json.dumps(content | more), encoding='utf-8')
        generator(str(order), *arguments)
        for template in templates.glob('*visibility_control.h.in'):
            generate_visibility_control_file(
                package_name=PACKAGE,
                template_path=template,
                output_path=output / 'msg' / template.stem,
            )

    run(
        generate_type_hash,
        'rosidl_generator_type_description',
        include_paths=[f'{name}:{get_package_share_directory(name)}' for name in TYPE_PACKAGES],
    )
    run(
        generate_c,
        'rosidl_generator_c',
        type_description_tuples=[f'{file}:{output / file.with_suffix(".json")}' for file in idl],
        ros_interface_files=[str(source / file) for file in files],
    )
    run(generate_typesupport_fastrtps_c, TYPE_SUPPORTS[0])
    run(
        generate_introspection_c,
        TYPE_SUPPORTS[1],
        output_dir=str(target / INTROSPECTION / PACKAGE),
    )
    run(generate_typesupport_c, 'rosidl_typesupport_c', TYPE_SUPPORTS)
    run(generate_py, 'rosidl_generator_py', ['rosidl_typesupport_c'])
    output.joinpath('__init__.py').touch()
