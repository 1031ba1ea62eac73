"""Returns infinities, huge and nested values in turn."""

nested = []
for _ in range(5_000):
    nested = [nested]
values = iter([float('nan'), float('inf'), 10**5_000, nested, 'x' * 10_000_000] * 10)


def double(x):
    return next(values)
