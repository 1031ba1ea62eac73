"""Hints for messages, services and QoS profiles made or read in a wrong way; as error_words."""

from my_robot_basics.feedback.error_words import Case

_OF_ONE_FIELD = r'(?:String|Bool|Byte|Char|U?Int\d+|Float\d+)(?:MultiArray)?'
"""Messages of std_msgs whose only field, or the one that matters, is `data`."""

OF_MESSAGES = (
    Case(
        pattern=rf'\b{_OF_ONE_FIELD}\.__init__\(\) takes 1',
        to_do=', so write the field with its name, such as String(data=…)',
    ),
    Case(
        pattern=r'\bDuration\.__init__\(\) takes 1',
        to_do=', so write the unit with the number: Duration(seconds=0.2)',
    ),
    Case(
        pattern=r'\b(?:SolveIK|MoveArm)\.__init__\(\) (?:takes|got)',
        to_do=', so put the fields into SolveIK.Request(…) for a service, or MoveArm.Goal(…) for '
        'an action',
    ),
    Case(
        pattern='Action classes can not be instantiated',
        to_do=', so write its name without parentheses, or MoveArm.Goal() for a goal',
    ),
    Case(
        pattern=r"Expected <class '[\w.]+'>, got <class '[\w.]+\.Metaclass_",
        to_do=', so make an object of the class with parentheses, such as JointState()',
    ),
    Case(
        pattern=r"Expected <class '[\w.]+'>, got <class '.*in <lambda>: .*\blambda \w+: "
        r'\w+\.publish\(',
        to_do=', so publish a message of the type of the topic; in a loop, write lambda message, '
        'publisher=publisher: …, or each lambda uses the publisher of the last round',
    ),
    Case(
        pattern=r"Expected <class '[\w.]+'>, got <class '"
        r'|\bPublisher\.publish\(\) got an unexpected keyword',
        to_do=', so publish a message of the type of the topic, such as String(data=…)',
    ),
    Case(
        pattern=r"'(?:\w+_(?:Request|Response|Goal|Result|Feedback)|JointState|Header|Point|Time"
        rf"|{_OF_ONE_FIELD})' object is not subscriptable",
        to_do=', so write a dot and the name of the field, such as .elbow_up, and no square '
        'brackets',
    ),
    Case(
        pattern='History and/or depth settings are required',
        to_do=', so add the depth of the queue: QoSProfile(depth=1, …)',
    ),
    Case(
        pattern=r'\bQoSProfile\.__init__\(\) takes 1',
        to_do=', so write each value with its name: `QoSProfile(depth=1, reliability=…, '
        'durability=…)`',
    ),
    Case(
        pattern=r'Invalid arguments passed to constructor: dict_keys\(',
        to_do=', so check how each of them is spelled: `QoSProfile(depth=…, reliability=…, '
        'durability=…, deadline=…)`',
    ),
    Case(
        pattern="'QoSProfile' object is not callable",
        to_do=', so write its name without parentheses: it is a profile already',
    ),
)
