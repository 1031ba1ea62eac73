"""Answers in turn with numbers that are none, and with too few and too many."""

import itertools
import math

TURNS = itertools.cycle([[math.nan] * 2, [math.inf, -math.inf], [], [0.0], [0.0] * 100_000])


class IKService(IKService):
    def solve(self, request, response):
        response.reachable = True
        response.elbow_up = next(TURNS)
        response.elbow_down = next(TURNS)
        return response
