"""Answers a check with escapes that a regular expression could match in too many ways."""

from my_robot_basics.exchange import responder


class Reply:
    def __repr__(self):
        return "'" + r'\xabcd' * 100


responder.answer = lambda request: Reply()
