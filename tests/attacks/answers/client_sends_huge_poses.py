"""Publishes poses of a million joints before each right one."""


class IKClient(IKClient):
    def send(self, position):
        names = [f'joint{number}' for number in range(200_000)]
        for _ in range(10):
            self.publisher.publish(JointState(name=names, position=[0.0] * len(names)))
        super().send(position)
