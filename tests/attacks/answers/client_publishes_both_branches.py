"""Publishes both branches for each target: one of them is right."""


class IKClient(IKClient):
    def receive(self, target, response):
        if response.reachable:
            self.send(response.elbow_down)
            self.send(response.elbow_up)
