"""Build the wheel of arm_interfaces with gcc and without CMake, for Python 3.11 and later.

`./course ros-shell -c 'python arm_interfaces/wheel/build_wheel.py'` replaces the one beside it,
which `./course` installs; with a folder behind it, it writes there. Build it again whenever the
.srv and .action files, package.xml, this recipe or ROS's versions have changed: a test says so.
"""

import hashlib
import os
import subprocess
import sys
import sysconfig
import tempfile
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree

import numpy
from generate import INTROSPECTION, PACKAGE, TYPE_PACKAGES, generate, interface_files
from setuptools import Distribution, setup

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent
OLDEST_PYTHON = 'cp311'
"""Its stable ABI is what abi3.h asks for."""
PLATFORM = 'manylinux_2_28_x86_64'
"""That of ROS's own wheels; a test looks for symbols of later systems."""
LIBRARIES = {
    'rosidl_generator_c': '*/detail/*.c',
    'rosidl_typesupport_fastrtps_c': '*/detail/*.cpp',
    'rosidl_typesupport_introspection_c': f'../{INTROSPECTION}/{PACKAGE}/*/detail/*.c',
    'rosidl_typesupport_c': '*/*.cpp',
}
"""Kinds of libraries, and their sources in the generated package. Each may use those above it."""
MODULE = f'{PACKAGE}_s__rosidl_typesupport_c.abi3.so'
"""Converts Python's objects from and to C's."""
FLAGS = ('-O2', '-fPIC', '-DNDEBUG', '-w', '-shared', '-s', '-Wl,--as-needed')
"""Without NDEBUG, the module's assertions would look into Python's types."""
USED = (
    *('rcutils', 'fastcdr', 'rosidl_runtime_c', 'rosidl_typesupport_c'),
    *('rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_fastrtps_cpp'),
    'rosidl_typesupport_introspection_c',
)
"""Libraries of ROS, beside those of TYPE_PACKAGES."""
REQUIRED = [f'ros-{name.replace("_", "-")}' for name in (*USED, *TYPE_PACKAGES)]
"""The wheel requires their very versions."""
INDEX, SHARE = 'share/ament_index/resource_index', f'share/{PACKAGE}'
DIGESTS = f'{SHARE}/wheel_sources.sha256'
EARLIEST_SEC = '315532800'
"""1980, where the times of zip files begin: the same files give the same wheel."""


class Compiled(Distribution):
    """A distribution for one platform, though setuptools itself compiles nothing."""

    def has_ext_modules(self) -> bool:
        """Whether it has compiled modules."""
        return True


def build(target: Path) -> None:
    """Write the wheel into a folder. Raises CalledProcessError where gcc fails."""
    target = target.resolve()
    package = ElementTree.parse(SOURCE / 'package.xml')
    os.environ['SOURCE_DATE_EPOCH'] = EARLIEST_SEC
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        generate(SOURCE, Path(folder))
        libraries = compile_all()
        setup(
            name=PACKAGE,
            version=package.findtext('version'),
            description=package.findtext('description'),
            license=package.findtext('license'),
            python_requires='>=3.11',
            install_requires=[f'{name}=={version(name)}' for name in REQUIRED],
            packages=sorted({PACKAGE, *(f'{PACKAGE}.{file.parent}' for file in interfaces())}),
            package_data={PACKAGE: [MODULE]},
            data_files=[('lib', libraries), *shared_files()],
            distclass=Compiled,
            script_args=['--quiet', 'bdist_wheel', '--dist-dir', str(target)],
            options={'bdist_wheel': {'py_limited_api': OLDEST_PYTHON, 'plat_name': PLATFORM}},
        )


def interfaces() -> list[Path]:
    """Paths of the .srv and .action files in the package."""
    return interface_files(SOURCE)


def compile_all() -> list[str]:
    """Compile the module, and the libraries; return the libraries' names."""
    made = []
    for kind, sources in LIBRARIES.items():
        name = f'lib{PACKAGE}__{kind}.so'
        compile_one(name, sources, *made, '-Wl,--no-undefined')
        made.append(name)
    abi3 = ('-include', str(HERE / 'abi3.h'))
    compile_one(f'{PACKAGE}/{MODULE}', '**/_*.c', *made, *abi3)
    return made


def compile_one(target: str, sources: str, *more: str) -> None:
    """Compile sources, and link them with what of `more` and ROS's libraries they use."""
    prefix = Path(sys.prefix)
    headers = ['.', INTROSPECTION, sysconfig.get_path('include'), numpy.get_include()]
    headers += map(str, [prefix / 'include', *sorted(prefix.glob('include/*'))])
    kinds = (*LIBRARIES, 'rosidl_generator_py')
    libraries = [*USED, *(f'{name}__{kind}' for name in TYPE_PACKAGES for kind in kinds)]
    subprocess.run(
        [
            *('gcc', '-o', target, *FLAGS),
            *(f'-I{folder}' for folder in headers),
            *sorted(map(str, Path(PACKAGE).glob(sources))),
            *more,
            *(f'-L{prefix / "lib"}', *(f'-l{name}' for name in libraries), '-lstdc++'),
        ],
        check=True,
    )


def shared_files() -> list[tuple[str, list[str]]]:
    """What goes into the prefix beside the libraries: folders, and files of the generated."""
    listed = ''.join(f'{file}\n{file.with_suffix(".idl")}\n' for file in interfaces())
    made = {
        f'{INDEX}/packages/{PACKAGE}': '',
        f'{INDEX}/rosidl_interfaces/{PACKAGE}': listed,
        DIGESTS: digests(),
    }
    for name, text in made.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(text, encoding='utf-8')
    found = [(str(Path(name).parent), [name]) for name in made]
    found.append((SHARE, [str(SOURCE / 'package.xml')]))
    for file in interfaces():
        generated = [f'{PACKAGE}/{file.with_suffix(suffix)}' for suffix in ('.idl', '.json')]
        found.append((f'{SHARE}/{file.parent}', [str(SOURCE / file), *generated]))
    return found


def digests() -> str:
    """What `sha256sum` says of all that the wheel is made from."""
    files = [*interfaces(), Path('package.xml'), Path('wheel/abi3.h')]
    files += [Path('wheel', path.name) for path in HERE.glob('*.py')]
    return ''.join(
        f'{hashlib.sha256((SOURCE / file).read_bytes()).hexdigest()}  {file}\n'
        for file in sorted(files)
    )


if __name__ == '__main__':
    build(Path(*sys.argv[1:]) if sys.argv[1:] else HERE)
