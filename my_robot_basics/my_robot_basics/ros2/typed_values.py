"""Parse YAML values that a user has typed."""

from typing import Any

from my_robot_basics.ros2.errors import CommandError


def parse(text: str | bytes) -> Any:
    """Return the value of a YAML text; raises CommandError."""
    import yaml

    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        raise CommandError(f'The passed value is not YAML: {error}') from None
