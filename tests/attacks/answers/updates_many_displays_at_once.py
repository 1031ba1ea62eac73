"""Shows a thousand small things under one name, and updates them all with millions of characters."""  # earns 3

from IPython.display import display

for _ in range(1_000):
    handle = display('x', display_id='many')
for _ in range(20):
    display('x' * 20_000_000, display_id='many', update=True)


def double(x):
    return x + x
