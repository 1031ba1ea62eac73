from setuptools import setup

setup(
    name='arm_player',
    version='0.1.0',
    packages=['arm_player'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/arm_player']),
        ('share/arm_player', ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='A student of the course',
    maintainer_email='student@example.com',
    description='Draws with the two-link arm: a driver, and a player that visits targets',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'arm_driver = arm_player.arm_driver:main',
            'arm_player = arm_player.arm_player:main',
        ],
    },
)
