"""Started by `./course` as `python -IS launcher/__main__.py`: see launcher/main.py."""

import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
# after the standard library: a file in the course's folder must not replace a module of it
sys.path.append(ROOT)

if sys.argv[1:] == ['--is-set-up']:
    from launcher.venv_inputs import is_set_up  # every call runs this, so it imports nothing else

    sys.exit(not is_set_up(ROOT))

from launcher.main import main  # noqa: E402

sys.exit(main(sys.argv[1:]))
