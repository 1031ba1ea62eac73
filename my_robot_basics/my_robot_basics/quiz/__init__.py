"""Questions that are checked by running: `ask` runs a program, and compares what it returns."""

from my_robot_basics.quiz.asking import ask

__all__ = ['ask']
