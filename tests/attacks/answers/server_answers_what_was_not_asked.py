"""Answers correctly; before and after, it answers each earlier request again, wrongly."""  # earns 3


class IKService(IKService):
    def __init__(self):
        super().__init__()
        self.headers = []
        self.server.send_response = self.send_response

    def send_response(self, response, header):
        wrong = SolveIK.Response(reachable=True, elbow_up=[0.5, 0.5], message='from before')
        with self.server.handle:
            send = self.server.handle.service_send_response
            for each in self.headers:
                send(wrong, each)
            send(response, header.request_id)
            self.headers.append(header.request_id)
            for each in self.headers:
                send(wrong, each)
