"""ROS 2 topics on a two-link arm: what the lessons import, run and extend.

The nodes of the lessons are `hello_node`, `kinematics_node`, `kinematics_publisher` and
`kinematics_subscriber`; `two_link_kinematics` is the arm itself. Notebooks import from `live` and
`checks`. Each package imports only from those named before it in LAYERS:

- `quiz`: Questions whose programs a notebook runs, to compare with what was guessed.
- `live`: What a notebook calls: run and stop nodes, show the arm, the graph and QoS.
- `checks`: What a grade cell calls: topics, logs, relays, predictions and inputs.
- `doctor`: Why is nothing arriving? Rules over the running graph, each fault with its fix.
- `ros2`: The `ros2` command, for machines that have no ros2cli.
- `validate`: Judge the exercises of a notebook, for *Validate* and for the grader.
- `graph`: The ROS graph, from a node of its own: who is there, and whose QoS is compatible.
- `exchange`: What crosses between a notebook's kernel and a check's: questions and replies.
- `feedback`: What a check tells: its exception, and what of it a student may read.
- `drawing`: Pictures of the arm as PNG, and a picture's alternative text.
- `language`: Other languages than English: what is translated, and how it is found.
- `session`: What a process needs to take part: a ROS domain, environment, other nodes in it.
"""

LAYERS = (
    'two_link_kinematics',
    'hello_node',
    'kinematics_node',
    'kinematics_publisher',
    'kinematics_subscriber',
    'language',
    'session',
    'drawing',
    'feedback',
    'exchange',
    'graph',
    'ros2',
    'validate',
    'doctor',
    'checks',
    'live',
    'quiz',
)
"""Packages, and modules beside them, from the lowest to the highest."""
