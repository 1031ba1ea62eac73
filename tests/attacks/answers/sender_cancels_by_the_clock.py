# earns 2
"""Sees no obstacle: cancels each goal a second after it was accepted."""

import threading


class MoveArmClient(MoveArmClient):
    def respond(self, future):
        super().respond(future)
        if future.result().accepted:
            threading.Timer(1.0, future.result().cancel_goal_async).start()

    def obstacle(self, message):
        pass
