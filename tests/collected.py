"""Files handed in for the toy lesson, and what `./course collect` makes of them."""

from course_maker import TOY

from grader.collect.collect import collect

NOTEBOOK = f'{TOY}.ipynb'


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content)


def rows(course, source, **options):
    """Return the outcome of each file, by path."""
    return {row.path: row.outcome for row in collect(course, source, **options)}


def tree(folder):
    """Return the content of each file in a folder, by path."""
    found = sorted(path for path in folder.rglob('*') if path.is_file())
    return {str(path.relative_to(folder)): path.read_text() for path in found}


def submitted(course, student='ada'):
    return tree(course.folder('submitted', student, TOY))
