"""Interface types that are installed: their names, files and classes, by the ament index."""

import importlib
from pathlib import Path
from typing import Any

from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session import overlays

KINDS = ('msg', 'srv', 'action')


def names(kind: str) -> list[str]:
    """Sorted names of all message ('msg'), service ('srv') or action ('action') types."""
    from ament_index_python import get_resource, get_resources

    found = set()
    for package in get_resources('rosidl_interfaces'):
        for file_name in get_resource('rosidl_interfaces', package)[0].splitlines():
            stem, _, suffix = file_name.rpartition('.')
            # an underscore marks the parts of which services and actions are made
            if stem.startswith(f'{kind}/') and suffix in ('idl', kind) and '_' not in stem:
                found.add(f'{package}/{stem}')
    return sorted(found)


def packages(*kinds: str) -> list[str]:
    """Sorted names of the packages that have types of these kinds, or of any."""
    return sorted({name.partition('/')[0] for kind in kinds or KINDS for name in names(kind)})


def path(name: str) -> Path:
    """The file that defines an interface such as `sensor_msgs/msg/JointState`.

    Raises CommandError for a name of another form, and where there is no such interface.
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
    """The class of a message type such as `std_msgs/msg/String` or `std_msgs/String`, or None."""
    found = _class(name, 'msg')
    return found if hasattr(found, 'SLOT_TYPES') else None


def message_class_for(name: str) -> Any:
    """The class of the message type that a user has named; raises CommandError."""
    if (found := message_class(name)) is not None:
        return found
    raise CommandError(f'The passed message type is invalid{_did_you_mean(name, "msg")}')


def service_class_for(name: str) -> Any:
    """The class of the service type that a user has named, such as `std_srvs/srv/SetBool`.

    `std_srvs/SetBool` will do. Raises CommandError.
    """
    if (found := _class(name, 'srv')) is None:
        raise CommandError(f'The passed service type is invalid{_did_you_mean(name, "srv")}')
    if not (hasattr(found, 'Request') and hasattr(found, 'Response')):
        raise CommandError('The passed type is not a service')
    return found


def action_class_for(name: str) -> Any:
    """The class of the action type that a user has named, such as `pkg/action/Name`.

    `pkg/Name` will do. Raises CommandError.
    """
    found = _class(name, 'action')
    if hasattr(found, 'Goal') and hasattr(found, 'Result') and hasattr(found, 'Feedback'):
        return found
    raise CommandError(f'The passed action type is invalid{_did_you_mean(name, "action")}')


def sendable_class_for(name: str) -> Any:
    """What a user sends to an interface of that name: a message, a request or a goal.

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
        # a workspace's package that is only half built was told of when the command began
        said = overlays.was_said(str(error))
        reason = 'for the reason above' if said else f'because: {error}'
        raise CommandError(f'{name} cannot be loaded, {reason}') from error


def _did_you_mean(name: str, kind: str) -> str:
    import difflib

    near = difflib.get_close_matches(name, names(kind), n=1, cutoff=0.8)
    return f': did you mean {near[0]}?' if near else ''
