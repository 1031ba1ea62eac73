"""Why nothing arrives on a topic, said and drawn in the notebook."""

import html

from my_robot_basics.doctor import looking, names, picture, report
from my_robot_basics.live import notebook
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import LiveError

STYLE = 'margin:0;font-size:13px;word-break:normal'
"""As large as other outputs, and broken between words: a line of code may be a long one."""


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
    told = report.tell(diagnosis)
    if not notebook.in_kernel():
        print(told)
        return
    as_html = f'<pre style="{STYLE}">{html.escape(told)}</pre>'
    notebook.Display().show({'text/plain': told, 'text/html': as_html})
    drawn, words = picture.draw(diagnosis), picture.describe(diagnosis)
    notebook.Display().show({'image/png': drawn, 'text/plain': words})
