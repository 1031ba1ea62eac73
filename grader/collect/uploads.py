"""What comes in: each file of a folder or an archive, and of the archives in it."""

import re
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path

from grader.collect.archive_entries import ARCHIVE
from grader.collect.archives import UnpackLimits, unpack
from grader.collect.incoming import Incoming, as_json, from_json
from grader.collect.live_folders import ONE, LiveFolder
from grader.collect.platforms import label_in
from grader.common.errors import CourseError
from grader.common.parsing import Limits, ParsingFailed, parse
from grader.notebook.submission import SECRET, TIMESTAMP

ALL = {'files': 100_000, 'bytes': 8_000_000_000}
"""A class of 500 with all its lessons and pictures."""
MAX_NESTED = 3
"""Archives within archives: a course management system's, a student's, and one more."""
LIMITS_OF_ALL = Limits(cpu_sec=900, wall_sec=3_600)
LIMITS_OF_ONE = Limits(cpu_sec=20, wall_sec=300)
"""What reading them may take: a student's largest one takes two seconds of processor time."""

OTHER_ARCHIVE = re.compile(r'\.(rar|7z|gz|bz2|xz|zst|lzh|cab|iso|dmg)$', re.IGNORECASE)
"""How names of archives end that can't be read here."""


def look_into(source: Path, aside: Path) -> Iterator[Incoming]:
    """Yield all files in a folder or an archive; `aside` is an empty folder for copies of them.

    Links are not followed. An archive in it is taken for a student's. Raises CourseError where
    there is nothing of the kind.
    """
    left = UnpackLimits(**ALL)
    # the name of one student's upload says whose it is; a class's may look like one of Canvas's
    name = source.resolve().name
    upload = (name,) if (label := label_in(name)) and label.platform.is_plain else ()
    live = LiveFolder(aside, UnpackLimits(**ALL), wanted)
    if source.is_dir():
        found = live.read(source, upload)
    elif source.is_file() and (upload or source.suffix == '.ipynb'):
        whoever = (source.stat().st_uid,)  # whoever collects it has named it
        found = live.read_entry(source.resolve().parent, name, trusted=whoever)
    elif source.is_file() and ARCHIVE.search(source.name):
        found = _apart('inside', Incoming((), source), source.name, aside, left, LIMITS_OF_ALL)
    else:
        raise CourseError(
            f'{source} is {"another kind of file" if source.exists() else "not there"}: expected '
            'a folder, a notebook or an archive (.zip, .tar, .tar.gz)'
        )
    yield from _unpacked(found, aside, left)


def look_into_entry(folder: Path, name: str, aside: Path) -> Iterator[Incoming]:
    """Yield all files of what lies under one name in a folder, as `look_into` does."""
    found = LiveFolder(aside, UnpackLimits(**ONE), wanted).read_entry(folder, name)
    yield from _unpacked(found, aside, UnpackLimits(**ONE))


def _unpacked(found: Iterator[Incoming], aside: Path, left: UnpackLimits) -> Iterator[Incoming]:
    """Yield files; of each archive among them, what is in it."""
    for each in found:
        if each.problem or each.litter or not ARCHIVE.search(each.parts[-1]):
            yield from _opened(each, aside, left, nested=1)
        else:
            part = left.part(**ONE)
            before = replace(part)
            yield from _apart('opened', each, each.parts[-1], aside, part, LIMITS_OF_ONE)
            left.less(before, part)
            each.readable.unlink()


def read_apart(way: str, outer: dict, name: str, aside: str, left: dict) -> dict:
    """Do in a process of its own what `_apart` asks for: JSON comes, and JSON goes."""
    allowance, archive = UnpackLimits(**left), from_json(outer)
    if way == 'inside':
        found = _inside(archive, name, Path(aside), allowance)
    else:
        found = _opened(archive, Path(aside), allowance, nested=1)
    return {'found': [as_json(each) for each in found], 'left': asdict(allowance)}


def _apart(
    way: str, outer: Incoming, name: str, aside: Path, left: UnpackLimits, limits: Limits
) -> Iterator[Incoming]:
    """Yield what is in an archive, 'inside' alone or 'opened' with the archives in it."""
    own = tempfile.mkdtemp(dir=aside)
    arguments = (way, as_json(outer), name, own, asdict(left))
    try:
        said = parse('grader.collect.uploads:read_apart', *arguments, limits=limits)
    except ParsingFailed as why:
        shutil.rmtree(own)
        yield replace(
            outer,
            parts=outer.parts or (name,),
            file=None,
            problem=f'it is not read, for {why}: ask for a new one, or unpack it by hand',
        )
        return
    vars(left).update(said['left'])
    yield from map(from_json, said['found'])


def wanted(name: str) -> bool:
    """Whether a file of that name is read at all."""
    return (
        name.endswith('.py')
        or name.lower().endswith('.ipynb')
        or name in (TIMESTAMP, SECRET)
        or ARCHIVE.search(name) is not None
    )


def _opened(each: Incoming, aside: Path, left: UnpackLimits, *, nested: int) -> Iterator[Incoming]:
    """Yield a file; of an archive, what is in it."""
    if each.problem or each.litter:
        yield each
    elif OTHER_ARCHIVE.search(each.parts[-1]) and not ARCHIVE.search(each.parts[-1]):
        yield replace(each, problem='an archive of another kind: ask for a .zip or .tar.gz')
    elif not ARCHIVE.search(each.parts[-1]):
        yield each
    elif nested > MAX_NESTED:
        yield replace(each, problem=f'more than {MAX_NESTED} archives within each other')
    else:
        part = left.part(**ONE)
        before = replace(part)
        for inner in _inside(each, each.parts[-1], aside, part):
            yield from _opened(inner, aside, part, nested=nested + 1)
        left.less(before, part)


def _inside(outer: Incoming, name: str, aside: Path, left: UnpackLimits) -> Iterator[Incoming]:
    for member in unpack(outer.readable, name=name, aside=aside, left=left, wanted=wanted):
        parts = outer.parts + member.parts
        yield Incoming(
            parts=parts or (name,),
            file=member.file,
            modified=outer.modified if outer.parts else member.modified,
            problem=member.problem,
            archive=outer.archive or len(outer.parts),
            login=outer.login,
            changed=outer.changed,
        )
