"""Builds the package for pip and for colcon alike."""

from setuptools import find_packages, setup

package_name = 'my_robot_basics'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    # Installed editable, this makes a plain path entry. Else `import my_robot_basics`, from the
    # folder above, would find this folder instead of the package in it.
    package_dir={'': '.'},
    package_data={'': ['py.typed', '*.xml', 'labextension/*.json', 'labextension/static/*.js']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['hypothesis', 'pytest']},  # colcon test looks here for pytest
    zip_safe=True,
    maintainer='my_robot_basics maintainers',
    maintainer_email='maintainers@example.com',
    description='ROS 2 topics on a two-link arm: the nodes of a course in notebooks',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'hello_node = my_robot_basics.hello_node:main',
            'kinematics_node = my_robot_basics.kinematics_node:main',
            'kinematics_publisher = my_robot_basics.kinematics_publisher:main',
            'kinematics_subscriber = my_robot_basics.kinematics_subscriber:main',
        ],
    },
)
