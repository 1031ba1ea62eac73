"""ROS packages that a package imports, but its package.xml does not name."""

import ament_index_python
import pytest
from my_robot_basics.live.packages.dependencies import undeclared_dependencies
from my_robot_basics.session import package_files
from package_maker import NODE, PACKAGE, make_package


@pytest.fixture
def undeclared(tmp_path):
    """Return a function that makes a package with changes and returns what it does not declare."""

    def of(**changes):
        make_package(tmp_path, **changes)
        return undeclared_dependencies(PACKAGE, package_files.read(tmp_path / PACKAGE))

    return of


def test_a_package_that_names_all_its_imports_is_not_reported(undeclared):
    assert undeclared() == ()


def test_each_undeclared_ros_package_is_reported_once(undeclared):
    code = f'from sensor_msgs.msg import JointState\nimport arm_interfaces.srv as srv\n{NODE}'
    arm, joints = undeclared(node=code, **{'greeter/more.py': 'import sensor_msgs'})
    assert arm == (
        'package.xml does not name arm_interfaces, which greeter/greet.py imports: on a robot, '
        'colcon and rosdep would not know that it is needed; add '
        '<depend>arm_interfaces</depend>'
    )
    assert 'does not name sensor_msgs, which greeter/greet.py imports' in joints


@pytest.mark.parametrize(
    'line',
    [
        'from . import sensor_msgs',
        'from .sensor_msgs import msg',
        'import numpy',
        'import sensor_msgs as',
        "'import sensor_msgs'",
    ],
)
def test_other_imports_need_no_entry_in_package_xml(undeclared, line):
    assert undeclared(**{'greeter/more.py': line}) == ()


def test_a_package_that_is_installed_need_not_declare_itself(undeclared, monkeypatch):
    installed = {PACKAGE: '/x', 'rclpy': '/x', 'std_msgs': '/x'}
    monkeypatch.setattr(ament_index_python, 'get_packages_with_prefixes', lambda: installed)
    assert undeclared(**{'greeter/more.py': 'from greeter import greet'}) == ()


def test_only_modules_of_the_package_itself_are_searched(undeclared):
    assert (
        undeclared(**{'test/test_x.py': 'import sensor_msgs', 'greeter/x.txt': 'import rcl'}) == ()
    )


def test_an_import_inside_a_function_counts(undeclared):
    (need,) = undeclared(**{'greeter/more.py': 'def f():\n    from sensor_msgs import msg'})
    assert 'which greeter/more.py imports' in need


@pytest.mark.parametrize('tag', ['depend', 'exec_depend', 'build_depend', 'buildtool_depend'])
def test_each_kind_of_dependency_names_a_package(tmp_path, tag):
    folder = make_package(tmp_path, **{'greeter/more.py': 'import sensor_msgs'})
    manifest = folder / 'package.xml'
    entry = f'<{tag}>sensor_msgs</{tag}>\n  <depend>rclpy</depend>'
    manifest.write_text(manifest.read_text().replace('<depend>rclpy</depend>', entry))
    assert undeclared_dependencies(PACKAGE, package_files.read(folder)) == ()
