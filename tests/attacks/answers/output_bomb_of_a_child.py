"""Prints without end from a program that it started."""

import subprocess

subprocess.Popen(['yes'])
subprocess.run(['yes'])
