"""`ros2 pkg create`: a Python package that colcon builds, made as a whole or not at all."""

import argparse

import pytest
from my_robot_basics.ros2 import skeleton
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.verbs import pkg_create


@pytest.fixture
def create(tmp_path, monkeypatch, capsys):
    """Call it in an empty folder; return the exit status, or the error, and what it printed."""
    monkeypatch.chdir(tmp_path)

    def call(*words):
        parser = argparse.ArgumentParser()
        pkg_create.add_arguments(parser)
        try:
            status = pkg_create.main(parser.parse_args(words))
        except CommandError as error:
            status = str(error)
        return status, capsys.readouterr().out

    return call


def test_a_package_is_created_with_a_node_and_dependencies(create, tmp_path):
    status, said = create(
        *('--build-type', 'ament_python', 'arm_player', '--node-name', 'arm_driver'),
        *('--dependencies', 'rclpy', 'arm_interfaces', '--description', 'Draws & <more>'),
    )
    assert not status
    assert 'creating ./arm_player/arm_player/arm_driver.py' in said
    folder = tmp_path / 'arm_player'
    manifest = (folder / 'package.xml').read_text()
    assert '<depend>rclpy</depend>\n  <depend>arm_interfaces</depend>' in manifest
    assert '<description>Draws &amp; &lt;more&gt;</description>' in manifest
    assert "'arm_driver = arm_player.arm_driver:main'," in (folder / 'setup.py').read_text()
    assert [path.name for path in tmp_path.iterdir()] == ['arm_player']


def test_an_existing_folder_is_left_unchanged(create, tmp_path):
    (tmp_path / 'arm_player').mkdir()
    status, _ = create('--build-type', 'ament_python', 'arm_player')
    assert "The directory 'arm_player' already exists" in status
    assert list((tmp_path / 'arm_player').iterdir()) == []


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (('arm_player',), 'makes no package of the build type ament_cmake'),
        (('--build-type', 'ament_python', '../x'), "'../x' is no name"),
        (('--build-type', 'ament_python', 'a', '--node-name', 'a/b'), "'a/b' is no name"),
    ],
)
def test_a_package_that_cannot_be_created_is_refused_with_a_reason(create, tmp_path, words, said):
    status, _ = create(*words)
    assert said in status
    assert list(tmp_path.iterdir()) == []


def test_a_failure_leaves_nothing_behind(tmp_path, monkeypatch):
    monkeypatch.setattr(skeleton, '_umask', lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        skeleton.make(tmp_path, 'arm_player')
    assert list(tmp_path.iterdir()) == []
