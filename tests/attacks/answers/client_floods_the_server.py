"""Sends requests as fast as it can."""

import threading
import time


class IKClient(IKClient):
    def __init__(self):
        super().__init__()
        threading.Thread(target=self.flood, daemon=True).start()

    def flood(self):
        while True:
            for number in range(200):
                point = Point(x=0.5 + number / 1000)
                future = self.client.call_async(SolveIK.Request(target=point))
                self.client.remove_pending_request(future)
            time.sleep(0.001)
