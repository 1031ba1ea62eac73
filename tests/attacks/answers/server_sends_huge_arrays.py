"""Answers with arrays and a text of a hundred megabytes each."""

HUGE = 12_000_000


class IKService(IKService):
    def solve(self, request, response):
        response = super().solve(request, response)
        response.elbow_up = [0.0] * HUGE
        response.message = 'x' * (8 * HUGE)
        return response
