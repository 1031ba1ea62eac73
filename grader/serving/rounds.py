"""Rounds over what lies in the inbound folder: nobody's many files keep others from being seen."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

MOST_FILES_AT_ONCE = 20_000
"""So many are looked at, in a fifth of a second, before what is graded is started and stored."""


@dataclass
class Rounds:
    """Which entries were looked at in this round: those that were not come next."""

    is_under_way: bool = False
    """Whether some have not been looked at yet since the round began."""
    _turn: int = 0
    _last: dict[str, int] = field(default_factory=dict)
    """When each was looked at last."""
    _since: set[str] = field(default_factory=set)
    _left: int = 0

    def of(self, entries: Iterable[tuple[str, str]]) -> Iterator[str]:
        """Yield names of entries, given with their owners, until enough was `counted`.

        Of each owner one comes before anybody's second one, and the one that waits longest first.
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

    def counted(self, files: int) -> None:
        """Note how many files were looked at."""
        self._left -= files

    def begin(self) -> None:
        """Begin a round: something has changed, or all was looked at."""
        self._since.clear()
