"""Files that are not taken, and why; a lesson in another format may be all that was handed in."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from grader.collect.incoming import Incoming
from grader.collect.name_forms import NameForms, stem_of
from grader.collect.naming import Owner
from grader.collect.platforms import label_in
from grader.common.dates import date_of
from grader.notebook.submission import SECRET, TIMESTAMP

_FORMAT = re.compile(r'\.(html?|pdf|py|json|txt|md|docx?|odt)$', re.IGNORECASE)
"""What a lesson may be exported, printed or copied to."""


@dataclass(frozen=True)
class UntakenFile:
    """A file that was not taken."""

    incoming: Incoming
    reason: str
    needs_attention: bool = True
    """Whether a person should look at it; if not, it would not be graded anyway."""


class UntakenReasons:
    """Says why files are not taken, beside the notebooks that are."""

    def __init__(
        self,
        owners: Mapping[Incoming, Owner],
        assignments: Iterable[str],
        others: Iterable[Incoming] = (),
        *,
        is_all: bool = True,
    ) -> None:
        """Look at each notebook and its owner; `others` may be notebooks, and have no owner.

        Unless that `is_all` that came in, a student's notebook may come in another entry.
        """
        self._is_all = is_all
        self._forms = NameForms(assignments)
        self._with_notebook = {self._find_upload(each) for each in (*owners, *others)}
        self._folders = {
            (owner.assignment, notebook.parts[: len(owner.above) + 1])
            for notebook, owner in owners.items()
            if owner.by_folder
        }
        self._files = {
            (owner.assignment, notebook.parts[:-1], _whose(notebook.parts[-1]))
            for notebook, owner in owners.items()
        }

    def unwanted(self, each: Incoming) -> UntakenFile:
        """Return why a file is not taken that is neither a notebook nor Python."""
        return self._find_reason_to_ask(each) or UntakenFile(
            each, 'neither a notebook nor Python', needs_attention=False
        )

    def unused(self, each: Incoming, *, in_upload: bool) -> UntakenFile:
        """Return why a file that could be beside a notebook does not belong to any of them."""
        if to_ask := self._find_reason_to_ask(each):
            return to_ask
        if each.parts[-1] == SECRET:
            return UntakenFile(
                each,
                'it belongs to the exchange, but to no submission here',
                needs_attention=False,
            )
        if each.parts[-1] != TIMESTAMP:
            return UntakenFile(
                each,
                'it is beside no notebook, or beside those of several students',
                needs_attention=False,
            )
        if each.archive or in_upload:
            where = 'archive' if each.archive else 'upload'
            return UntakenFile(
                each, f'its time is not used: a student can write any time into an {where}'
            )
        if date_of(each.readable) is None:
            return UntakenFile(each, 'it holds no date')
        return UntakenFile(each, 'it is beside no notebook of one student')

    def _find_reason_to_ask(self, each: Incoming) -> UntakenFile | None:
        """Return the reason for a file if its student may have handed in no notebook at all."""
        if alone := self._lesson_alone(each):
            return alone
        upload = self._find_upload(each) if self._is_all else None
        if upload is None or upload in self._with_notebook:
            return None
        _, student, _ = upload
        return UntakenFile(
            each,
            f'there is no notebook in what {student} handed in: ask for it (in JupyterLab: File, '
            'Download)',
        )

    def _find_upload(self, each: Incoming) -> tuple[tuple[str, ...], str, str] | None:
        """Return where the upload is that a file is in, its student and number; None if in none.

        Only names by platforms and the exchange say that something is all of a student's upload.
        """
        for at, name in enumerate(each.parts):
            if label := label_in(name):
                return each.parts[:at], label.student, label.number
            if exchanged := self._forms.parse_exchange_name(name):
                return each.parts[: at + 1], exchanged.student, ''
        return None

    def _lesson_alone(self, each: Incoming) -> UntakenFile | None:
        """Return the reason for a lesson in another format, without a notebook of its student."""
        *folders, name = each.parts
        if not _FORMAT.search(name):
            return None
        name = _FORMAT.sub('.ipynb', name)
        label = label_in(name)
        lesson = self._forms.assignment_in(stem_of(label.rest if label else name))
        if not lesson:
            return None
        above = [(lesson, each.parts[:number]) for number in range(1, len(each.parts))]
        beside = (lesson, tuple(folders), _whose(name))
        if beside in self._files or not self._folders.isdisjoint(above):
            return None
        return UntakenFile(
            each, f'no notebook: ask for {lesson}.ipynb (in JupyterLab: File, Download)'
        )


def _whose(name: str) -> tuple[str, str]:
    """Return what a notebook's name says about its student: a platform's words, or all of it."""
    label = label_in(name)
    return (label.student, label.number) if label else (stem_of(name), '')
