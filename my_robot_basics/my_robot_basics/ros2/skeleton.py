"""The files of a new Python package of ROS, as `ros2 pkg create` makes them."""

import getpass
import os
import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape

NAME = re.compile(r'[a-z][a-z0-9_]*')
"""Pattern of a package's name."""
TODO = 'TODO: Package description'
NO_LICENSE = 'TODO: License declaration'

_MANIFEST = """<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format3.xsd" schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>{description}</description>
  <maintainer email="{email}">{maintainer}</maintainer>
  <license>{license}</license>
{depends}
  <test_depend>python3-pytest</test_depend>

  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
_SETUP = """from setuptools import find_packages, setup

package_name = '{name}'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer={maintainer!r},
    maintainer_email={email!r},
    description={description!r},
    license={license!r},
    entry_points={{
        'console_scripts': [{entry}],
    }},
)
"""
_SETUP_CFG = """[develop]
script_dir=$base/lib/{name}
[install]
install_scripts=$base/lib/{name}
"""
_NODE = """def main():
    print('Hi from {name}.')


if __name__ == '__main__':
    main()
"""


def make(
    above: Path,
    name: str,
    *,
    node_name: str = '',
    dependencies: Sequence[str] = (),
    description: str = TODO,
    license: str = NO_LICENSE,
    maintainer: str = '',
    email: str = '',
) -> list[str]:
    """Create the package's folder in `above`, completely or not at all; return its files' paths.

    Raises FileExistsError if the folder, or a file of that name, exists.
    """
    target = above / name
    if target.exists() or target.is_symlink():
        raise FileExistsError(target)
    maintainer = maintainer or getpass.getuser()
    about = {
        'name': name,
        'description': description,
        'license': license,
        'maintainer': maintainer,
        'email': email or f'{maintainer}@todo.todo',
    }
    line = f"'{node_name} = {name}.{node_name}:main',"
    entry = f'\n{" " * 12}{line}\n{" " * 8}' if node_name else ''
    depends = [f'\n  <depend>{escape(each)}</depend>' for each in dependencies]
    files = {
        'package.xml': _MANIFEST.format(
            **{key: escape(value, {'"': '&quot;'}) for key, value in about.items()},
            depends=''.join([*depends, '\n']) if depends else '',
        ),
        'setup.py': _SETUP.format(**about, entry=entry),
        'setup.cfg': _SETUP_CFG.format(name=name),
        f'resource/{name}': '',
        f'{name}/__init__.py': '',
    }
    if node_name:
        files[f'{name}/{node_name}.py'] = _NODE.format(name=name)
    unfinished = Path(tempfile.mkdtemp(prefix=f'.{name}-', dir=above))
    try:
        for path, text in files.items():
            (unfinished / path).parent.mkdir(exist_ok=True)
            (unfinished / path).write_text(text, encoding='utf-8')
        unfinished.chmod(0o777 & ~_umask())
        unfinished.rename(target)
    except BaseException:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise
    return list(files)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
