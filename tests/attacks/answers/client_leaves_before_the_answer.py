"""Sends requests with clients that it destroys before the response, then with its own client."""  # earns 4


class IKClient(IKClient):
    def __init__(self):
        super().__init__()
        self.others = [self.create_client(SolveIK, '/solve_ik') for _ in range(20)]

    def ask(self, target):
        if self.others:
            client = self.others.pop()
            client.call_async(SolveIK.Request(target=target))
            self.destroy_client(client)
        super().ask(target)
