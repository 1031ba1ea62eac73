"""Keeps each request for ten minutes."""

import time


class IKService(IKService):
    def solve(self, request, response):
        time.sleep(600.0)
        return super().solve(request, response)
