"""What an editable install lacks in .venv: ROS's index, Jupyter's files, and the tools."""

import json
import os
import re
import shutil
from pathlib import Path

from launcher.environment import Environment
from launcher.venv_inputs import KERNELS, SAFE_PATH, TOOLS, UNDERLAY

TOOL = r"""#!/bin/sh
# PYTHON_ARGCOMPLETE_OK
# {name}, of the package that is installed here
exec "${{0%/*}}/python" -P "${{0%/*}}/../../my_robot_basics/my_robot_basics/ros2/start.py" {module} "$@"
"""  # noqa: E501
BUTTON = 'my_robot_basics/my_robot_basics/validate/labextension'
KERNEL = 'share/jupyter/kernels/my_robot_basics_sandbox'


def register_with_ament(environment: Environment) -> None:
    """Install what ROS looks for: the marker in the index, package.xml and executables."""
    venv, package = environment.venv, environment.root / 'my_robot_basics'
    index = venv / 'share/ament_index/resource_index/packages'
    share, executables = venv / 'share/my_robot_basics', venv / 'lib/my_robot_basics'
    if executables.is_dir():
        shutil.rmtree(executables)
    for folder in (index, share, executables):
        folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(package / 'resource/my_robot_basics', index)
    shutil.copy(package / 'package.xml', share)
    for name in executables_of((package / 'setup.py').read_text(encoding='utf-8')):
        (executables / name).symlink_to(f'../../bin/{name}')
    for script in ('local_setup.sh', 'local_setup.bash'):
        (venv / script).write_text(UNDERLAY, encoding='utf-8')


def executables_of(setup: str) -> list[str]:
    """Return the names of the executables in a package's setup.py."""
    return re.findall(r"^ *'([a-z0-9_]*) = my_robot_basics\.", setup, re.MULTILINE)


def install_jupyter_files(environment: Environment) -> None:
    """Install the Validate button, its server extension, and the configuration of kernels."""
    venv, button = environment.venv, environment.root / BUTTON
    extensions, server = venv / 'share/jupyter/labextensions', venv / 'etc/jupyter'
    server /= 'jupyter_server_config.d'
    for folder in (extensions, server):
        folder.mkdir(parents=True, exist_ok=True)
    make_symlink(extensions / 'my_robot_basics_validate', button)
    shutil.copy(button / 'server.json', server / 'my_robot_basics.json')
    (venv / 'etc/ipython').mkdir(parents=True, exist_ok=True)
    (venv / 'etc/ipython/ipython_kernel_config.py').write_text(KERNELS, encoding='utf-8')
    make_kernelspec_safe(venv / 'share/jupyter/kernels/python3/kernel.json')
    if environment.has_grader:
        (venv / KERNEL).mkdir(parents=True, exist_ok=True)
        shutil.copy(environment.root / 'grader/kernels/kernelspec/kernel.json', venv / KERNEL)


def make_kernelspec_safe(file: Path) -> None:
    """Make a kernel start with SAFE_PATH: Jupyter starts it as soon as a notebook is opened.

    The file is replaced, not changed: uv links the files of .venv to those of its cache.
    """
    if not file.exists():
        return
    spec = json.loads(file.read_text(encoding='utf-8'))
    python, *options = spec['argv']
    if SAFE_PATH not in options:
        spec['argv'] = [python, SAFE_PATH, *options]
        part = file.with_name(f'{file.name}.part')
        part.write_text(json.dumps(spec, indent=1), encoding='utf-8')
        os.replace(part, file)


def make_symlink(link: Path, target: Path) -> None:
    """Make a symbolic link; replace an existing one."""
    link.unlink(missing_ok=True)
    link.symlink_to(target)


def make_tools(environment: Environment) -> None:
    """Write the tools as new files: an installer may have hard-linked colcon to its cache."""
    for name, module in TOOLS.items():
        tool = environment.venv / 'bin' / name
        tool.unlink(missing_ok=True)
        tool.write_text(TOOL.format(name=name, module=module), encoding='utf-8')
        os.chmod(tool, 0o755)
