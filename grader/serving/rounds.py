"""Rounds over the inbound folder: one owner's many files don't keep those of others waiting."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

MOST_FILES_AT_ONCE = 20_000
"""Files that are checked in one go, in a fifth of a second, before gradings go on."""


@dataclass
class Rounds:
    """Which entries were checked in this round: the others come next."""

    is_under_way: bool = False
    """Whether some entries have not been checked yet in this round."""
    _turn: int = 0
    _last: dict[str, int] = field(default_factory=dict)
    """The turn in which each entry was checked last."""
    _since: set[str] = field(default_factory=set)
    _left: int = 0

    def entries_in_turn(self, entries: Iterable[tuple[str, str]]) -> Iterator[str]:
        """Yield names of entries, given with their owners, until enough files were counted.

        One entry of each owner comes before the second one of any; the longest unchecked come
        first.
        """
        names = dict(sorted(entries, key=lambda each: (self._last.get(each[0], 0), each[0])))
        ranks: dict[str, int] = {}
        of_owner = Counter[str]()
        for name, owner in names.items():
            ranks[name] = of_owner[owner]
            of_owner[owner] += 1
        self._last = {name: at for name, at in self._last.items() if name in names}
        self._left = MOST_FILES_AT_ONCE
        for name in sorted(names, key=lambda each: (ranks[each], self._last.get(each, 0))):
            if self._left <= 0:
                break
            self._turn += 1
            self._last[name] = self._turn
            self._since.add(name)
            yield name
        self.is_under_way = not names.keys() <= self._since
        if not self.is_under_way:
            self.begin()

    def count_files(self, files: int) -> None:
        """Subtract the files that were checked."""
        self._left -= files

    def begin(self) -> None:
        """Begin a new round: something has changed, or all entries were checked."""
        self._since.clear()
