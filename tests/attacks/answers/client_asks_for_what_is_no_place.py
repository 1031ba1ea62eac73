"""Requests targets that are not numbers, or extremely far away, before each right one."""  # earns 2

import math

FAR = (math.nan, math.inf, -math.inf, 1.7e308, -1.7e308, 5e-324)


class IKClient(IKClient):
    def ask(self, target):
        for x in FAR:
            for y in FAR:
                self.client.call_async(SolveIK.Request(target=Point(x=x, y=y)))
        super().ask(target)
