"""ROS packages that a package imports, but its package.xml does not name."""

import pytest
from my_robot_basics.live.package_needs import undeclared_dependencies
from my_robot_basics.session import package_files
from package_maker import NODE, PACKAGE, make_package


@pytest.fixture
def needs(tmp_path):
    """Return a function that makes a package with changes and returns its unnamed needs."""

    def of(**changes):
        make_package(tmp_path, **changes)
        return undeclared_dependencies(PACKAGE, package_files.read(tmp_path / PACKAGE))

    return of


def test_a_package_that_names_all_its_imports_is_not_reported(needs):
    assert needs() == ()


def test_each_unnamed_ros_package_is_reported_once(needs):
    code = f'from sensor_msgs.msg import JointState\nimport arm_interfaces.srv as srv\n{NODE}'
    arm, joints = needs(node=code, **{'greeter/more.py': 'import sensor_msgs'})
    assert arm == (
        'package.xml does not name arm_interfaces, which greeter/greet.py imports: on a robot, '
        'colcon and rosdep would not know that it is needed; add '
        '<depend>arm_interfaces</depend>'
    )
    assert 'does not name sensor_msgs, which greeter/greet.py imports' in joints
