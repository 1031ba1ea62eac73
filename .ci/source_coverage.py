"""Each heading of the lesson that this course grew out of is taught by a cell that is named here.

`.venv/bin/python .ci/source_coverage.py` prints which is not. The headings are told in our own
words; a cell is named by lesson and id, with a word that it says.
"""

import sys
from pathlib import Path

import nbformat

SOLUTIONS = Path(__file__).parents[1] / 'solutions'

ARM, TOPICS, MESSAGE = '00_two_link_arm', '01_topics', '02_joint_state'
PUBLISHER, SUBSCRIBER, COMMANDS = '03_publisher', '04_subscriber', '05_command_line'
QOS, ERRORS = '06_qos', '07_common_errors'

TAUGHT = {
    'preface: a node that cannot speak yet': [
        (ARM, 'kinematics', 'KinematicsNode'),
        (ARM, 'silent', 'silent'),
        (ARM, 'its_topics', 'get_publisher_names_and_types_by_node'),
        (ARM, 'problem', 'log'),
        (PUBLISHER, 'smallest', 'nothing more'),
    ],
    '5.1 what a topic is': [(TOPICS, 'contract', 'Topics')],
    '5.1.1 like radio': [(TOPICS, 'radio_words', 'radio'), (TOPICS, 'nobody', 'Station')],
    '5.1.2 not like a function call': [
        (TOPICS, 'call_words', 'decoupled'),
        (TOPICS, 'call', 'motor'),
        (TOPICS, 'dies', 'stop'),
    ],
    '5.1.3 its three attributes': [
        (TOPICS, 'names_words', 'name'),
        (TOPICS, 'type_words', 'type'),
        (TOPICS, 'qos_words', 'QoS'),
    ],
    '5.2 choose a message type': [(MESSAGE, 'contract', 'JointState')],
    '5.2.1 do not invent one': [
        (MESSAGE, 'standard_first', 'sensor_msgs/msg/JointState'),
        (MESSAGE, 'standard_first', 'geometry_msgs/msg/Point'),
    ],
    '5.2.2 how a joint state is built': [
        (MESSAGE, 'fields', 'get_fields_and_field_types'),
        (MESSAGE, 'units', 'rad'),
        (MESSAGE, 'frame', 'base_link'),
        (MESSAGE, 'pairs_moral', 'velocity'),
    ],
    '5.2.3 how to look a message up': [
        (MESSAGE, 'definition_file', 'ros2 interface show sensor_msgs/msg/JointState'),
        (MESSAGE, 'other_types', 'ros2 interface list | grep sensor_msgs'),
    ],
    '5.3 publish joint angles': [(PUBLISHER, 'contract', 'talking')],
    '5.3.1 the idea: a timer, and a topic of its own': [
        (PUBLISHER, 'smallest', 'create_timer'),
        (PUBLISHER, 'whose_topic', 'robot_state_publisher'),
        (PUBLISHER, 'mixed', 'zeros'),
    ],
    '5.3.2 the whole publisher': [
        (PUBLISHER, 'publish_pose', 'KinematicsPublisher.publish_pose'),
        (PUBLISHER, 'full_node', 'oldest'),
        (PUBLISHER, 'whose_topic', '/joint_states'),
        (PUBLISHER, 'urdf', 'robot_state_publisher'),
    ],
    '5.3.3 its entry point': [
        (PUBLISHER, 'greeter', 'rclpy.spin'),
        (PUBLISHER, 'entry_point_words', 'setup.py'),
    ],
    '5.3.4 build it and run it': [
        (PUBLISHER, 'colcon', 'colcon build --packages-select my_robot_basics'),
        (PUBLISHER, 'colcon', 'source install/setup.bash'),
    ],
    '5.4 subscribe to joint angles': [(SUBSCRIBER, 'contract', 'listens')],
    '5.4.1 the idea: there and back': [
        (SUBSCRIBER, 'callback', 'callback'),
        (SUBSCRIBER, 'round_trip', 'FK'),
        (SUBSCRIBER, 'check_pose', 'KinematicsSubscriber'),
        (SUBSCRIBER, 'half_of_all', 'elbow_down'),
    ],
    '5.4.2 its entry point': [(SUBSCRIBER, 'processes', 'entry point')],
    '5.4.3 two terminals': [(SUBSCRIBER, 'two_processes', 'kinematics_subscriber')],
    '5.5 watch from the command line': [
        (COMMANDS, 'topic_list', 'ros2 topic list'),
        (COMMANDS, 'topic_info', 'ros2 topic info /kinematics/joint_states'),
        (COMMANDS, 'topic_echo', 'ros2 topic echo'),
        (COMMANDS, 'topic_hz', 'ros2 topic hz /kinematics/joint_states'),
    ],
    '5.6 QoS': [(QOS, 'contract', 'promises')],
    '5.6.1 why there is QoS': [(QOS, 'wishes', 'requirements')],
    '5.6.2 two parameters to begin with': [
        (QOS, 'reliability', 'RELIABLE'),
        (QOS, 'busy', 'depth=depth'),
    ],
    '5.6.3 which pairs match': [
        (QOS, 'claim', 'tutorials'),
        (QOS, 'as_taught', '/as_taught'),
        (QOS, 'matrix', 'show_qos_matrix'),
        (QOS, 'verbose', '--verbose'),
    ],
    '5.7 common errors': [(ERRORS, 'contract', 'Common errors')],
    '5.7.1 nothing arrives, though both nodes run': [
        (ERRORS, 'method', 'ros2 topic list'),
        (ERRORS, 'silence', 'ros2 topic echo'),
        (ERRORS, 'seven_listeners', 'spelling'),
    ],
    '5.7.2 the unit of position': [
        (MESSAGE, 'right_and_wrong', 'degrees'),
        (ERRORS, 'drawn_wrong', 'math.radians'),
    ],
    '5.7.3 the stamp forgotten': [
        (MESSAGE, 'stamp_rule', 'without stamps'),
        (ERRORS, 'synchroniser', 'stamp'),
    ],
    '5.8 exercises': [(PUBLISHER, 'exercise', 'five_hz')],
    '5.8.1 another rate': [
        (PUBLISHER, 'exercise', '5 times a second'),
        (PUBLISHER, 'four_hz', 'ros2 topic hz'),
    ],
    '5.8.2 a target point, and IK': [
        (SUBSCRIBER, 'exercise', '/target_point'),
        (SUBSCRIBER, 'ik_solver_node-try', 'ros2 topic pub --once /target_point'),
    ],
    '5.8.3 who publishes, who subscribes': [
        (COMMANDS, 'exercise', 'find_endpoints'),
        (COMMANDS, 'explain', 'Publisher count'),
    ],
    'summary: each concept in one sentence': [
        (ERRORS, 'checklist', 'create_publisher'),
        (ERRORS, 'checklist', 'create_subscription'),
        (ERRORS, 'checklist', 'JointState'),
        (ERRORS, 'checklist', 'QoS'),
    ],
    'reference code: publisher and subscriber': [
        (PUBLISHER, 'imports', 'kinematics_publisher'),
        (SUBSCRIBER, 'check_pose', 'kinematics_subscriber'),
    ],
    'preview: service and action': [
        (ERRORS, 'other_patterns', 'action'),
        (ERRORS, 'service', 'create_service'),
        (ERRORS, 'action', 'stops on request'),
    ],
}
"""Heading -> (lesson, cell, a word that the cell must say)."""


def main() -> int:
    """Print what is not taught as the table says; return 1 where there is such a thing."""
    gaps = 0
    for heading, cells in TAUGHT.items():
        for lesson, cell, word in cells:
            notebook = nbformat.read(SOLUTIONS / lesson / f'{lesson}.ipynb', as_version=4)
            said = {each.id: each.source for each in notebook.cells}.get(cell, '')
            if word not in said:
                gaps += 1
                print(f'{heading}: {lesson}, {cell} does not say {word!r}')
    return 1 if gaps else 0


if __name__ == '__main__':
    sys.exit(main())
