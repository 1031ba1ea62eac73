"""Subscribes to the description with VOLATILE: it misses what was published before it joined."""

from joint_state_monitor import JointStateMonitor, spin

if __name__ == '__main__':
    spin(JointStateMonitor, description=10)
