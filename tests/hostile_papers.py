"""Submissions that try to stop the program that reads them."""

import json

from grader.notebook.raw_notebook import MAX_CELLS

CODE = {'cell_type': 'code', 'source': 'x = 1', 'metadata': {}, 'outputs': []}


def notebook_text(*cells, **more):
    return json.dumps({'nbformat': 4, 'nbformat_minor': 5, 'metadata': {}, 'cells': cells} | more)


LARGE = ','.join(['{"cells":[{}]}'] * 60_000)

STOPS_DATEUTIL = '1:99999999999999999999999999999.5'
"""A time for which dateutil raises an unexpected exception."""
ONE_MEGABYTE = {
    'objects': f'{{"nbformat": 4, "cells": [{",".join(["{}"] * 333_000)}]}}',
    'worksheets': f'{{"nbformat": 3, "worksheets": [{LARGE}]}}',
    'outputs': notebook_text(CODE | {'outputs': [{'output_type': 'x'}] * 30_000}),
    'ids that are all one': notebook_text(*[CODE | {'id': 'a' * 64}] * MAX_CELLS),
    'lists in lists': notebook_text(CODE, metadata=[json.loads('[' * 90 + ']' * 90)] * 5_000),
    'long floats': notebook_text(CODE)[:-1] + f', "x": [{",".join(["1." + "7" * 700] * 1_400)}]}}',
    'backslashes': notebook_text(CODE | {'source': '\\' * 400_000}),
    'lines without a character': notebook_text(CODE | {'source': [''] * 240_000}),
}
