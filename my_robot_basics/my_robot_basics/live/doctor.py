"""Why nothing arrives on a topic, said and drawn in the notebook."""

from my_robot_basics.doctor import looking, names, picture, report
from my_robot_basics.live import classroom, notebook
from my_robot_basics.live.errors import LiveError


class NoTopicName(LiveError):
    """What was asked about can't be the name of a topic."""


def why(topic_name: str, *, domains: bool = False) -> None:
    """Look at a topic and print why messages do not arrive there, the likeliest cause first.

    Each cause comes with what was expected, what was seen, and what to do; below stands a picture
    of the graph with the broken edge marked. When all is well it says so, with the rate. With
    `domains` it looks at the other ROS domains of this machine, too. Raises NoTopicName.
    """
    try:
        full_name = names.full_topic_name(topic_name)
    except ValueError as error:
        raise NoTopicName(str(error)) from None
    diagnosis = looking.diagnose(full_name, domain_id=classroom.enter(), other_domains=domains)
    print(report.tell(diagnosis))
    if notebook.in_kernel():
        text = picture.describe(diagnosis)
        display = notebook.Display()
        display.show({'image/png': picture.draw(diagnosis), 'text/plain': text})
