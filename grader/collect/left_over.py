"""Which files belong to no submission, after all notebooks have taken what is theirs, and why."""

from collections.abc import Iterable, Iterator, Mapping

from grader.collect.companions import Companions
from grader.collect.incoming import Incoming
from grader.collect.naming import Owner
from grader.collect.package_folders import NO_NOTEBOOK, IncomingPackage, needs_attention
from grader.collect.untaken import UntakenFile, UntakenReasons

Beside = dict[tuple[str, ...], dict[str, Incoming]]
"""By folder: the files in it that may belong to a notebook, by name."""


def left_of_packages(
    folders: Iterable[IncomingPackage], companions: Iterable[Companions]
) -> Iterator[UntakenFile]:
    """Yield files of packages that were not taken, and all of packages without a notebook."""
    chosen = [each for with_it in companions for each in with_it.packages.values()]
    for _, files in chosen:
        for each, why in files.left:
            yield UntakenFile(each, why, needs_attention=needs_attention(why))
    for folder in folders:
        if not any(folder is there for there, _ in chosen):
            yield from (UntakenFile(each, NO_NOTEBOOK) for each in folder.members)


def left_beside(
    beside: Beside,
    owners: Mapping[Incoming, Owner],
    companions: Iterable[Companions],
    reasons: UntakenReasons,
) -> Iterator[UntakenFile]:
    """Yield files beside notebooks that were not taken, those of other users first."""
    used, foreign = set[Incoming](), dict[Incoming, str]()
    for with_it in companions:
        used |= with_it.used_files()
        foreign |= with_it.foreign
    yield from (UntakenFile(each, why) for each, why in foreign.items())
    uploads = {notebook.parts[:-1] for notebook, owner in owners.items() if owner.label}
    for folder, files in beside.items():
        for each in files.values():
            if each not in used and each not in foreign:
                yield reasons.unused(each, in_upload=folder in uploads)
