"""Our own package of lesson 12, and changes that students may make in theirs."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

LESSON = '12_package'
SOURCE = Path(__file__).parents[1] / 'solutions' / LESSON / 'arm_player'
CHECKS = 'package_builds', 'package_runs', 'arm_player_plays'
FULL = 1, 2, 4

PLAYER, DRIVER, SETUP = 'arm_player/arm_player.py', 'arm_player/arm_driver.py', 'setup.py'
Files = dict[str, str]


def ours() -> Files:
    """Return the files of our own package, by path."""
    paths = (path for path in SOURCE.rglob('*') if path.is_file())
    texts = {str(p.relative_to(SOURCE)): p for p in paths if '__pycache__' not in p.parts}
    return {name: path.read_text(encoding='utf-8') for name, path in sorted(texts.items())}


def write(files: Files, folder: Path) -> None:
    """Write a package into a folder named `arm_player`, beside a notebook."""
    for name, text in files.items():
        (folder / 'arm_player' / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / 'arm_player' / name).write_text(text, encoding='utf-8')


@dataclass(frozen=True)
class Change:
    """One student's change of the package."""

    name: str
    make: Callable[[Files], None]
    points: tuple[float, ...] = FULL
    says: dict[str, str] = field(default_factory=dict)
    """What the reason for a check's lost points has to contain."""

    def files(self) -> Files:
        """Return the files of the changed package."""
        files = ours()
        self.make(files)
        return files


def swap(file: str, *pairs: tuple[str, str]) -> Callable[[Files], None]:
    """Return a change that replaces texts in a file; each text must be there."""

    def make(files: Files) -> None:
        for old, new in pairs:
            if old not in files[file]:
                raise ValueError(f'{file} has no {old!r}')
            files[file] = files[file].replace(old, new)

    return make


def without(*names: str) -> Callable[[Files], None]:
    """Return a change that leaves files out."""

    def make(files: Files) -> None:
        for name in names:
            del files[name]

    return make
