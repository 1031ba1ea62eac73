"""Names in rclpy, as parts of regular expressions; written down, since importing rclpy is slow."""

OWN_PROPERTIES = (
    'handle|clients|timers|publishers|subscriptions|services|executor|context|waitables|guards'
    '|default_callback_group'
)
"""Node's properties."""
OWN_METHODS = (
    'get_(?:logger|clock|name|namespace|parameters?)|declare_parameters?|set_parameters'
    '|create_(?:publisher|subscription|client|service|timer)|destroy_node'
)
"""Methods of Node that a student may override by accident."""
OWN_ATTRIBUTES = (
    *('_publishers', '_subscriptions', '_clients', '_services', '_timers', '_parameters'),
    *('_descriptors', '_clock', '_logger', '_context', '_default_callback_group'),
)
"""Attributes in which Node keeps what it needs; a student's class may have one of that name."""
CLASSES = (
    'Node|Publisher|Client|Service|Subscription|Timer|Clock|Time|Duration|Future|RcutilsLogger'
    '|Parameter|Action(?:Client|Server)|(?:Client|Server)GoalHandle|Random'
)
"""Classes whose methods are not a student's; `random.uniform` is a method of Random."""
