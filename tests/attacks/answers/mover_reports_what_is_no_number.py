# earns 1
"""Reports positions that are not numbers, too few, or far too many, in turn."""

import itertools

TURNS = itertools.cycle([[math.nan] * 2, [math.inf, -math.inf], [], [0.0], [0.0] * 100_000])


class MoveArmServer(MoveArmServer):
    def tell(self, handle, left):
        handle.publish_feedback(MoveArm.Feedback(position=next(TURNS), remaining=math.nan))

    def result(self):
        return MoveArm.Result(position=next(TURNS))
