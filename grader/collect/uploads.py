"""Yield the collected files: those of a folder or an archive, and of the archives in it."""

import re
import shutil
import tempfile
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from grader.collect.archive_entries import ARCHIVE
from grader.collect.archives import unpack
from grader.collect.incoming import Incoming, as_json, from_json
from grader.collect.live_folders import LiveFolder
from grader.collect.name_forms import strip_late_mark
from grader.collect.platforms import label_in, owner_in
from grader.collect.unpack_limits import OF_USER, ONE, UnpackLimits
from grader.common.errors import CourseError
from grader.common.parsing import Limits, ParsingFailed, parse
from grader.notebook.submission import SECRET, TIMESTAMP

ALL = {'files': 100_000, 'bytes': 8_000_000_000}
"""Limits for all of it: enough for a class of 500 with all its lessons and pictures."""
MAX_NESTED = 3
"""Archives within archives: a course platform's, a student's, and one more."""
LIMITS_OF_ALL = Limits(cpu_sec=900, wall_sec=3_600)
LIMITS_OF_ONE = Limits(cpu_sec=20, wall_sec=300)
"""Limits for reading an archive: a student's largest one takes two seconds of CPU time."""

OTHER_ARCHIVE = re.compile(r'\.(rar|7z|gz|bz2|xz|zst|lzh|cab|iso|dmg)$', re.IGNORECASE)
"""File name endings of archives that can't be read here."""
UNREAD = {
    OTHER_ARCHIVE: 'an archive of another kind: ask for a .zip or .tar.gz',
    re.compile(r'\.ipynb(\.(txt|json|download)| \(\d+\))$', re.IGNORECASE): (
        'a notebook with another ending: rename it to end in .ipynb, and collect it again'
    ),
    re.compile(r'\.(eml|mbox)$', re.IGNORECASE): 'a mail: save its attachments, and collect them',
}
"""Names of files that may be a student's only submission, and what a person can do."""


def read_upload(source: Path, aside: Path, packages: Collection[str] = ()) -> Iterator[Incoming]:
    """Yield all files in a folder or an archive; `aside` is an empty folder for copies of them.

    All files of ROS packages are read if they are in `packages`, those that lessons need. Links
    are not followed. An archive inside counts as a student's. Raises CourseError if `source` is
    not a folder, a notebook or an archive.
    """
    left = UnpackLimits(**ALL)
    opener = _Opener(frozenset(packages))
    # the name of a single upload says whose it is; for Canvas, it may be the name of a class
    name = source.resolve().name
    upload = (name,) if (label := label_in(name)) and label.platform.is_plain else ()
    live = LiveFolder(aside, UnpackLimits(**ALL), opener.is_wanted)
    if source.is_dir():
        found = live.read(source, upload)
    elif source.is_file() and (upload or source.suffix == '.ipynb'):
        whoever = (source.stat().st_uid,)  # the person who collects it chose this file
        found = live.read_entry(source.resolve().parent, name, trusted=whoever)
    elif source.is_file() and ARCHIVE.search(source.name):
        found = opener.read_in_process(
            'unpack_one', Incoming((), source), source.name, aside, left, LIMITS_OF_ALL
        )
    else:
        raise CourseError(
            f'{source} is {"another kind of file" if source.exists() else "not there"}: expected '
            'a folder, a notebook or an archive (.zip, .tar, .tar.gz)'
        )
    yield from opener.unpack_uploads(found, aside, left)


def read_inbound_entry(
    folder: Path, name: str, aside: Path, packages: Collection[str] = ()
) -> Iterator[Incoming]:
    """Yield all files of one entry in a folder, as `read_upload` does."""
    opener = _Opener(frozenset(packages))
    found = LiveFolder(aside, UnpackLimits(**ONE), opener.is_wanted).read_entry(folder, name)
    yield from opener.unpack_uploads(found, aside, UnpackLimits(**ONE))


def read_archive_as_json(
    way: str, outer: dict, name: str, aside: str, left: dict, packages: list[str]
) -> dict:
    """Unpack an archive in the process that `read_in_process` uses; all values are JSON."""
    allowance, archive = UnpackLimits(**left), from_json(outer)
    opener = _Opener(frozenset(packages))
    if way == 'unpack_one':
        found = opener.unpack_one(archive, name, Path(aside), allowance)
    else:
        found = opener.unpack_nested(archive, Path(aside), allowance, nested=1)
    return {'found': [as_json(each) for each in found], 'left': asdict(allowance)}


def is_wanted(parts: tuple[str, ...], packages: Collection[str] = ()) -> bool:
    """Whether a file of that path is read at all."""
    name = parts[-1]
    return (
        name.endswith('.py')
        or name.lower().endswith('.ipynb')
        or name in (TIMESTAMP, SECRET)
        or ARCHIVE.search(name) is not None
        or any(package_in(part) in packages for part in parts[:-1])
    )


def package_in(folder: str) -> str:
    """Return the name of the package that a folder or an archive may contain."""
    label = label_in(folder)
    name = strip_late_mark(ARCHIVE.sub('', (label and label.rest) or folder))
    return re.sub(r'(-\d+| \(\d+\))$', '', name)


@dataclass(frozen=True)
class _Opener:
    """Opens archives, and the archives in them."""

    packages: frozenset[str]

    def is_wanted(self, parts: tuple[str, ...]) -> bool:
        """Whether a file of that path is read at all."""
        return is_wanted(parts, self.packages)

    def unpack_uploads(
        self, found: Iterator[Incoming], aside: Path, left: UnpackLimits
    ) -> Iterator[Incoming]:
        """Yield files; for an archive, the files in it."""
        of_owners: defaultdict[object, UnpackLimits] = defaultdict(lambda: UnpackLimits(**OF_USER))
        for each in found:
            if each.problem or each.is_litter or not ARCHIVE.search(each.parts[-1]):
                yield from self.unpack_nested(each, aside, left, nested=1)
            else:
                name, owner = each.parts[-1], each.login or owner_in(each.parts)
                within = () if each.login else (left,)
                with (of_owners[owner] if owner else left).lend(*within, **ONE) as part:
                    yield from self.read_in_process(
                        'unpack_nested', each, name, aside, part, LIMITS_OF_ONE
                    )
                each.readable.unlink()

    def read_in_process(
        self, way: str, outer: Incoming, name: str, aside: Path, left: UnpackLimits, limits: Limits
    ) -> Iterator[Incoming]:
        """Read an archive in a separate process, with one of the two methods below."""
        own = tempfile.mkdtemp(dir=aside)
        arguments = (way, as_json(outer), name, own, asdict(left), sorted(self.packages))
        try:
            said = parse('grader.collect.uploads:read_archive_as_json', *arguments, limits=limits)
        except ParsingFailed as why:
            shutil.rmtree(own)
            yield replace(
                outer,
                parts=outer.parts or (name,),
                file=None,
                problem=f'it was not read, because {why}: ask for a new one, or unpack it by hand',
            )
            return
        vars(left).update(said['left'])
        yield from map(from_json, said['found'])

    def unpack_nested(
        self, each: Incoming, aside: Path, left: UnpackLimits, *, nested: int
    ) -> Iterator[Incoming]:
        """Yield a file; for an archive, the files in it."""
        if each.problem or each.is_litter:
            yield each
        elif not ARCHIVE.search(each.parts[-1]):
            why = [why for form, why in UNREAD.items() if form.search(each.parts[-1])]
            yield replace(each, problem=why[0]) if why else each
        elif nested > MAX_NESTED:
            yield replace(each, problem=f'more than {MAX_NESTED} archives within each other')
        else:
            with left.lend(**ONE) as part:
                for inner in self.unpack_one(each, each.parts[-1], aside, part):
                    yield from self.unpack_nested(inner, aside, part, nested=nested + 1)

    def unpack_one(
        self, outer: Incoming, name: str, aside: Path, left: UnpackLimits
    ) -> Iterator[Incoming]:
        """Yield the files in one archive; archives in it are not opened."""
        members = unpack(
            outer.readable,
            name=name,
            aside=aside,
            left=left,
            wanted=lambda parts: self.is_wanted(outer.parts + parts),
        )
        for member in members:
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
