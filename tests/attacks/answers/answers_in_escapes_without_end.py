"""Answers a check with escapes that can be read in more ways than anybody has time for."""

from my_robot_basics.exchange import responder


class Reply:
    def __repr__(self):
        return "'" + r'\xabcd' * 100


responder.answer = lambda request: Reply()
