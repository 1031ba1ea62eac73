"""Answers a check with lone surrogates, zero bytes and invalid escape sequences."""

import itertools

from my_robot_basics.exchange import responder

BROKEN = itertools.cycle(['\\ud800', '\0', '\\x', '\\N{none}', '\\U00110000', '\r'])


class Reply:
    def __repr__(self):
        return f"'{next(BROKEN)}'"


responder.answer = lambda request: Reply()
