"""Installed interface types: their names, files and classes, from the ament index."""

import importlib
from pathlib import Path
from typing import Any

from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session import overlays

KINDS = ('msg', 'srv', 'action')


def names(kind: str) -> list[str]:
    """Return the names of all types of a kind, 'msg', 'srv' or 'action', sorted."""
    from ament_index_python import get_resource, get_resources

    found = set()
    for package in get_resources('rosidl_interfaces'):
        for file_name in get_resource('rosidl_interfaces', package)[0].splitlines():
            stem, _, suffix = file_name.rpartition('.')
            # names with an underscore are parts of services and actions
            if stem.startswith(f'{kind}/') and suffix in ('idl', kind) and '_' not in stem:
                found.add(f'{package}/{stem}')
    return sorted(found)


def packages(*kinds: str) -> list[str]:
    """Return the names of the packages with types of these kinds, by default of any, sorted."""
    return sorted({name.partition('/')[0] for kind in kinds or KINDS for name in names(kind)})


def path(name: str) -> Path:
    """Return the file that defines an interface such as `sensor_msgs/msg/JointState`.

    Raises CommandError for a name of another form, and if there is no such interface.
    """
    from ament_index_python import has_resource

    parts = name.split('/')
    if len(parts) != 3:
        raise CommandError(f"Invalid name '{name}'. Expected three parts separated by '/'")
    if not all(parts):
        raise CommandError(f"Invalid name '{name}'. Must not contain empty parts")
    if '..' in parts:
        raise CommandError(f"Invalid name '{name}'. Must not contain '..'")
    package, kind, last = parts
    prefix = has_resource('packages', package) if package.isidentifier() else None
    if not prefix:
        raise CommandError(f"Unknown package '{package}'")
    file = Path(prefix, 'share', package, kind, last)
    if '.' not in last:
        with_kind = file.with_name(f'{last}.{kind}')
        file = with_kind if with_kind.is_file() else file.with_name(f'{last}.idl')
    if not file.is_file():
        raise CommandError(f"Could not find the interface '{file}'")
    return file


def message_class(name: str) -> Any:
    """Return a message class by name, `std_msgs/msg/String` or `std_msgs/String`; or None."""
    found = _class(name, 'msg')
    return found if hasattr(found, 'SLOT_TYPES') else None


def message_class_for(name: str) -> Any:
    """Return the class of a message type from the command line; raises CommandError."""
    if (found := message_class(name)) is not None:
        return found
    raise CommandError(f'The passed message type is invalid{_did_you_mean(name, "msg")}')


def service_class_for(name: str) -> Any:
    """Return the class of a service type from the command line.

    Both `std_srvs/srv/SetBool` and `std_srvs/SetBool` are accepted. Raises CommandError.
    """
    if (found := _class(name, 'srv')) is None:
        raise CommandError(f'The passed service type is invalid{_did_you_mean(name, "srv")}')
    if not (hasattr(found, 'Request') and hasattr(found, 'Response')):
        raise CommandError('The passed type is not a service')
    return found


def action_class_for(name: str) -> Any:
    """Return the class of an action type from the command line.

    Both `pkg/action/Name` and `pkg/Name` are accepted. Raises CommandError.
    """
    found = _class(name, 'action')
    if hasattr(found, 'Goal') and hasattr(found, 'Result') and hasattr(found, 'Feedback'):
        return found
    raise CommandError(f'The passed action type is invalid{_did_you_mean(name, "action")}')


def sendable_class_for(name: str) -> Any:
    """Return the class that a user sends to an interface: its message, request or goal.

    Raises CommandError.
    """
    kind = name.split('/')[1] if name.count('/') == 2 else 'msg'
    if kind == 'srv':
        return service_class_for(name).Request
    return action_class_for(name).Goal if kind == 'action' else message_class_for(name)


def _class(name: str, kind: str) -> Any:
    parts = name.split('/')
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or not all(part.isidentifier() for part in parts) or parts[1] not in KINDS:
        return None
    try:
        return getattr(importlib.import_module('.'.join(parts[:2])), parts[2], None)
    except ModuleNotFoundError:
        return None
    except ImportError as error:
        # a half-built package of a workspace was reported when the command started
        said = overlays.was_said(str(error))
        reason = 'for the reason above' if said else f'because: {error}'
        raise CommandError(f'{name} cannot be loaded, {reason}') from error


def _did_you_mean(name: str, kind: str) -> str:
    import difflib

    near = difflib.get_close_matches(name, names(kind), n=1, cutoff=0.8)
    return f': did you mean {near[0]}?' if near else ''
