"""Gives joints and positions in the other order, which is right, too."""

from five_hz import FiveHz, spin


class SwappedNames(FiveHz):
    def joint_state(self):
        message = super().joint_state()
        message.name = ['joint2', 'joint1']
        message.position = [2.0, 1.5]
        return message


def main():
    spin(SwappedNames)


if __name__ == '__main__':
    main()
