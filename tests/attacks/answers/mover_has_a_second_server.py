"""A second server answers the goals that the first one does not move for."""


class MoveArmServer(MoveArmServer):
    def __init__(self):
        super().__init__()
        self.second = ActionServer(
            self,
            MoveArm,
            '/move_arm',
            self.execute,
            goal_callback=lambda _: GoalResponse.ACCEPT,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
