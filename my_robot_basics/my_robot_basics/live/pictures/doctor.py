"""Show in the notebook why no message arrives on a topic, or why a service does not answer."""

from my_robot_basics.doctor import as_html, diagnosing, names, picture, report
from my_robot_basics.doctor.evidence import Diagnosis
from my_robot_basics.language.speaking import language_here
from my_robot_basics.live.output import notebook, troubles
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import LiveError


class NoSuchName(LiveError):
    """The argument can't be the name of a topic or a service."""


def why(name: str, *, domains: bool = False) -> None:
    """Print why messages do not arrive on a topic, or why a service or action does not answer.

    The likeliest cause comes first, each with what was expected, what was seen, and what to do.
    Below is a picture of the graph with the broken edge marked. If all is well, it says so, with
    the rate of a topic. A service is not called. Waiting callbacks are found only in nodes of this
    notebook. With `domains`, it also searches the other ROS domains of this machine. Raises
    NoSuchName.
    """
    try:
        full_name = names.full_name(name)
    except ValueError as error:
        raise NoSuchName(str(error)) from None
    found = diagnosing.diagnose(
        full_name,
        domain_id=classroom.enter(),
        other_domains=domains,
        raised=troubles.last_raised_in_service,
    )
    for diagnosis in found:
        _show(diagnosis)


def _show(diagnosis: Diagnosis) -> None:
    told = report.tell(diagnosis, language_here())
    if not notebook.in_kernel():
        print(told)
        return
    page = as_html.tell_as_html(diagnosis, language_here())
    notebook.Display().show({'text/plain': told, 'text/html': page})
    drawn, words = picture.draw(diagnosis), picture.describe(diagnosis)
    notebook.show_picture(drawn, words)
