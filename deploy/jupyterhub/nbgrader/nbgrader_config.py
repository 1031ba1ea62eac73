"""Where this hub's students fetch and submit lessons; JUPYTER_CONFIG_PATH has this folder."""

import tomllib
from pathlib import Path

SETTINGS = tomllib.loads((Path(__file__).parents[1] / 'class.toml').read_text(encoding='utf-8'))

c = get_config()  # noqa: F821
c.CourseDirectory.course_id = SETTINGS['course']
c.Exchange.root = SETTINGS['exchange']
c.Exchange.assignment_dir = str(Path.home() / 'lessons')
