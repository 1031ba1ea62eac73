"""Names of rclpy, as parts of regular expressions: where rclpy is not needed, it costs time."""

OWN_PROPERTIES = (
    'handle|clients|timers|publishers|subscriptions|services|executor|context|waitables|guards'
    '|default_callback_group'
)
"""Node's properties."""
OWN_METHODS = (
    'get_(?:logger|clock|name|namespace|parameters?)|declare_parameters?|set_parameters'
    '|create_(?:publisher|subscription|client|service|timer)|destroy_node'
)
"""Those of its methods that a student may define by chance."""
CLASSES = (
    'Node|Publisher|Client|Service|Subscription|Timer|Clock|Time|Duration|Future|RcutilsLogger'
    '|Parameter|Action(?:Client|Server)|(?:Client|Server)GoalHandle|Random'
)
"""Classes whose methods no student has written; `random.uniform` is one of Random's."""
