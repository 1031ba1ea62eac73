"""Gives the joints names that are not in the URDF."""

from five_hz import FiveHz, spin


class WrongNames(FiveHz):
    def joint_state(self):
        message = super().joint_state()
        message.name = ['joint_1', 'joint_2']
        return message


def main():
    spin(WrongNames)


if __name__ == '__main__':
    main()
