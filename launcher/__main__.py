"""Started by `./course` as `python -IS launcher`: see launcher/main.py."""

import sys
from pathlib import Path

# behind the standard library: a file in the course's folder replaces no module of it
sys.path[:] = [*sys.path[1:], str(Path(__file__).resolve().parents[1])]

from launcher.main import main  # noqa: E402

sys.exit(main(sys.argv[1:]))
