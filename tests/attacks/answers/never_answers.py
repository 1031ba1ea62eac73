"""Never returns from the call of the check."""


def double(x):
    while True:
        try:
            while True:
                pass
        except BaseException:
            pass
