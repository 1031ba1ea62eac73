"""Sends goals as often as it can."""

import threading
import time


class MoveArmClient(MoveArmClient):
    def __init__(self):
        super().__init__()
        threading.Thread(target=self.flood, daemon=True).start()

    def flood(self):
        while True:
            for number in range(200):
                self.client.send_goal_async(MoveArm.Goal(position=[number / 200, 0.1], speed=0.5))
            time.sleep(0.001)
