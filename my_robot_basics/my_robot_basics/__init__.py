"""ROS 2 topics on a two-link arm: what the lessons import, run and extend.

The nodes of the lessons are `hello_node`, `kinematics_node`, `kinematics_publisher` and
`kinematics_subscriber`; `two_link_kinematics` is the arm itself. Notebooks import from `live` and
`checks`. Each package imports only from those named before it in LAYERS:

- `quiz`: Questions about programs; a notebook runs them and compares with the predictions.
- `live`: What a notebook calls: run and stop nodes, show the arm, the graph and QoS.
- `checks`: What a grade cell calls: topics, logs, relays, predictions and inputs.
- `doctor`: Why is nothing arriving? Rules over the running graph, each fault with its fix.
- `ros2`: The `ros2` command, for machines that have no ros2cli.
- `validate`: Judge the exercises of a notebook, for *Validate* and for the grader.
- `graph`: The ROS graph, seen by an observer node: which endpoints exist, and QoS compatibility.
- `exchange`: Requests and replies between a notebook's kernel and the kernel of a check.
- `feedback`: The exception of a failed check, and which part of it a student may read.
- `drawing`: Pictures of the arm as PNG, and a picture's alternative text.
- `language`: Translation of messages into languages other than English.
- `session`: What a process needs to take part in a lesson: ROS domain, environment, neighbours.
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
"""The packages and single modules, lowest layer first: each may import from earlier ones only."""
