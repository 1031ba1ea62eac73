"""Publishes a hundred counts at once, and then waits for the server inside its callback."""  # earns 2


class IKClient(IKClient):
    def ask(self, target):
        if not self.client.service_is_ready():
            for _ in range(100):
                self.say_alive()
            self.client.wait_for_service(timeout_sec=60.0)
        super().ask(target)
