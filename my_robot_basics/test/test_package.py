"""The package as a robot's owner builds it (colcon), and as the course installs it (pip)."""

import importlib.metadata
import os
import shutil
import subprocess
import sys
import textwrap
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]
BIN = Path(sys.executable).parent
NODES = {'hello_node', 'kinematics_node', 'kinematics_publisher', 'kinematics_subscriber'}

FOUND = """
import os
from ament_index_python import get_package_prefix
import my_robot_basics

prefix = get_package_prefix('my_robot_basics')
executables = os.listdir(os.path.join(prefix, 'lib', 'my_robot_basics'))
print(prefix, my_robot_basics.__file__, *executables)
"""


class Workspace:
    def __init__(self, folder):
        self.folder = folder
        self.package = folder / 'src' / 'my_robot_basics'
        shutil.copytree(
            PACKAGE,
            self.package,
            ignore=shutil.ignore_patterns('__pycache__', '*.egg-info', 'build'),
        )

    def bash(self, script):
        """Run a script in the workspace, as in a new terminal; return what it prints."""
        finished = subprocess.run(
            ['bash', '-c', 'set -e\n' + script],
            cwd=self.folder,
            env={**os.environ, 'PATH': f'{BIN}:{os.environ["PATH"]}'},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding='utf-8',
        )
        assert finished.returncode == 0, finished.stdout
        return finished.stdout

    def build(self, *options):
        self.bash(' '.join(['colcon build --packages-select my_robot_basics', *options]))

    def executables(self):
        """Ask the ament index, in a shell that sourced the workspace."""
        printed = self.bash(f'source install/setup.bash\npython - <<"END"\n{FOUND}\nEND')
        prefix, imported, *names = printed.split()
        assert Path(prefix) == self.folder / 'install' / 'my_robot_basics'
        assert Path(imported).is_relative_to(self.folder)
        return set(names)

    def first_line(self, executable):
        """Run an executable as `ros2 run` does until it logs; then end it."""
        return self.bash(f"""
            source install/setup.bash
            coproc node {{ exec install/my_robot_basics/lib/my_robot_basics/{executable} 2>&1; }}
            pid=$node_PID
            read -r line <&"${{node[0]}}"
            kill -TERM $pid
            wait $pid || true  # how a node ends is seen elsewhere
            echo "$line"
        """)


@pytest.fixture
def workspace(own_domain, tmp_path):
    return Workspace(tmp_path)


symlink_install = pytest.param(
    ['--symlink-install'],
    marks=pytest.mark.xfail(
        ' ' in sys.executable,
        reason='setuptools quotes a Python whose path has a space, in a first line of a script',
        strict=True,
    ),
)


@pytest.mark.parametrize('options', [[], symlink_install])
def test_the_ament_index_finds_each_node_of_a_colcon_build(workspace, options):
    workspace.build(*options)
    assert workspace.executables() == NODES
    assert '[hello_node]: Hello' in workspace.first_line('hello_node')


@pytest.mark.slow  # test_workspace.py builds a new node, too
def test_a_students_own_node_is_found_after_the_next_build(workspace):
    workspace.build()
    (workspace.package / 'my_robot_basics' / 'five_hz.py').write_text(
        textwrap.dedent("""
            import rclpy
            from rclpy.node import Node

            class FiveHz(Node):
                def __init__(self):
                    super().__init__('five_hz')
                    self.get_logger().info('mine')

            def main(args=None):
                rclpy.init(args=args)
                rclpy.spin(FiveHz())
        """)
    )
    setup = workspace.package / 'setup.py'
    before = "            'kinematics_node = "
    line = "            'five_hz = my_robot_basics.five_hz:main',\n"
    setup.write_text(setup.read_text().replace(before, line + before))
    workspace.build()
    assert workspace.executables() == NODES | {'five_hz'}
    assert '[five_hz]: mine' in workspace.first_line('five_hz')


@pytest.mark.slow
def test_a_colcon_build_installs_the_xml_files(workspace):
    workspace.build()
    (installed,) = workspace.folder.glob('install/my_robot_basics/lib/python*/site-packages')
    source = PACKAGE / 'my_robot_basics'
    expected = {path.relative_to(PACKAGE) for path in source.rglob('*.xml')}
    assert expected
    assert {path.relative_to(installed) for path in installed.rglob('*.xml')} == expected


def test_an_editable_install_is_imported_in_the_folder_above_the_package():
    printed = subprocess.run(
        [sys.executable, '-c', 'import my_robot_basics; print(my_robot_basics.__file__)'],
        cwd=PACKAGE.parent,
        stdout=subprocess.PIPE,
        encoding='utf-8',
        check=True,
    ).stdout
    # the outer folder, taken for a namespace package, would have no file: None
    assert Path(printed.strip()).parts[-2:] == ('my_robot_basics', '__init__.py')


def test_pip_and_ros_read_the_same_description():
    pip = importlib.metadata.metadata('my_robot_basics')
    ros = ElementTree.parse(PACKAGE / 'package.xml').getroot()
    assert ros.findtext('name') == pip['Name']
    assert ros.findtext('version') == pip['Version']
    assert ros.findtext('license') == pip['License']
    assert ros.find('maintainer').get('email') == pip['Maintainer-email'].strip('<>')
    assert ros.findtext('description') == pip['Summary']


def test_pip_installs_every_executable():
    entry_points = importlib.metadata.distribution('my_robot_basics').entry_points
    scripts = {point.name: point for point in entry_points if point.group == 'console_scripts'}
    assert set(scripts) == NODES
    for name, point in scripts.items():
        assert (BIN / name).is_file()
        assert callable(point.load())
