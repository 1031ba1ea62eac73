"""Asks for the description as for any topic: what was said before it joined is not for it."""

from joint_state_monitor import JointStateMonitor, spin

if __name__ == '__main__':
    spin(JointStateMonitor, description=10)
