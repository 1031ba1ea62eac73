"""The grade cells' checks of a client of /solve_ik."""

from my_robot_basics.checks import ik, serve
from nodes.running import imported

from arm_interfaces.srv import SolveIK

IKClient = imported('ik_client').IKClient

TARGETS = [(1.2, 0.4), (-0.5, 1.1), (0.9, -1.3)]


def server(answer=ik.solve):
    return serve(
        '/solve_ik',
        SolveIK,
        answer,
        asked_on='/target_point',
        to='/kinematics/joint_states',
        alive='/ik_client/alive',
    )


def check_asks():
    with server() as serving:
        for target in TARGETS:
            ik.expect_answer(serving, *target)
        ik.expect_no_answer(serving, 2.5, 0.0)


def check_never_blocks():
    with server() as serving:
        ik.expect_never_blocks(serving, *TARGETS)
