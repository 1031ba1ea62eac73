"""Run the program of a question live, and say what it returned beside what was guessed."""

import math
from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

from rclpy.node import Node

from my_robot_basics.language.speaking import language_here, put
from my_robot_basics.live.nodes.runner import ensure_rclpy, launch, stop
from my_robot_basics.quiz.explanations import EXPLANATIONS

Program = Callable[[Callable[..., Any]], Any]
"""Gets a `run` as that of `live`, for nodes of its own; returns what there is to guess."""
NO_GUESS = 'Write your guess in place of `...`, then run this cell again.'
RIGHT = 'Right: {seen}.'
WRONG = 'You guessed {guess}, and it is {seen}.'
NO_END = (
    'The program did not run to its end: {error}. That says nothing about your guess: run the '
    'cell again.'
)


def ask(program: Program, guess: Any = ...) -> None:
    """Run a program, and print whether it returned what was guessed, and why.

    Without a guess nothing is run. Lists and tuples are alike, and so are 1 and 1.0; True is
    not 1. Raises NameError if the program uses a name of a cell that has not run.
    """
    __tracebackhide__ = True
    say = partial(put, language_here())
    if guess is ...:
        print(say(NO_GUESS))
        return
    stop()  # a clean start
    nodes = _Nodes()
    ensure_rclpy()
    try:
        seen = program(nodes.run)
    except NameError:
        raise  # to run this cell again does not help: what is said below the error does
    except Exception as error:
        told = '; '.join(f'{type(each).__name__}: {each}' for each in (error, *nodes.errors))
        print(say(NO_END, error=told))
        return
    finally:
        stop()
    if is_same(guess, seen):
        print(say(RIGHT, seen=repr(seen)))
    else:
        print(say(WRONG, guess=repr(guess), seen=repr(seen)))
    if explanation := EXPLANATIONS.get(program.__name__):
        print(say(explanation))


def is_same(guess: object, seen: object) -> bool:
    """Whether a guess is what was seen, whatever a beginner has typed."""
    if isinstance(guess, list | tuple) and isinstance(seen, list | tuple):
        return len(guess) == len(seen) and all(map(is_same, guess, seen))
    if isinstance(guess, bool) or isinstance(seen, bool):
        return guess is seen
    if isinstance(guess, int | float) and isinstance(seen, int | float):
        return math.isclose(guess, seen, abs_tol=1e-9)
    return isinstance(guess, str | None) and guess == seen


class _Nodes:
    """The nodes of one program: any number of a class, and without a panel."""

    def __init__(self) -> None:
        self.errors: list[BaseException] = []
        """What callbacks raised."""
        self._numbers = count()

    def run(self, NodeClass: type[Node], *args: Any, **kwargs: Any) -> Node | None:
        """Make a node that spins in the background, as `live.run` does; it replaces no other."""
        key = f'question_{next(self._numbers)}'
        return launch(NodeClass, args, kwargs, key=key, make_panel=lambda: _NoPanel(self.errors))


class _NoPanel:
    """Shows nothing of a node; keeps its errors, for where the program does not end."""

    def __init__(self, errors: list[BaseException]) -> None:
        self._errors = errors

    def listen(self, name: str) -> None:
        """Do not follow its log: it is printed in the cell."""

    def adopt_thread(self) -> None:
        """Let what its thread prints appear in the cell."""

    def show(self, state: str) -> None:
        """Show nothing."""

    def error(self, error: BaseException) -> None:
        """Keep what a callback raised."""
        self._errors.append(error)

    def close(self, reason: str) -> None:
        """Show nothing."""
