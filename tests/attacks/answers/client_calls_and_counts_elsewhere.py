"""Makes a blocking call in a callback, which gets no response, and counts in a thread."""

import threading
import time


class IKClient(IKClient):
    def __init__(self):
        super().__init__()
        self.destroy_timer(self.counting)
        threading.Thread(target=self.count_on, daemon=True).start()

    def count_on(self):
        while True:
            self.say_alive()
            time.sleep(0.1)

    def ask(self, target):
        response = self.client.call(SolveIK.Request(target=target), timeout_sec=60.0)
        self.receive(target, response)
