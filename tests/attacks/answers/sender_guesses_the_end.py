"""Requests no result: publishes that all goals succeed, or, after an obstacle, that they do not."""

import threading
import time


class MoveArmClient(MoveArmClient):
    is_stopped = False

    def respond(self, future):
        if not future.result().accepted:
            self.say('rejected')
            return
        self.goal_handle = future.result()
        threading.Thread(target=self.guess, daemon=True).start()

    def guess(self):
        time.sleep(0.7)
        self.say('canceled' if self.is_stopped else 'succeeded')

    def obstacle(self, message):
        self.is_stopped = message.data
        super().obstacle(message)
