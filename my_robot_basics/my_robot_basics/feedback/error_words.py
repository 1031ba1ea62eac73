"""Hints for exceptions of Python and rclpy, in a table of patterns of their messages."""

from typing import NamedTuple

from my_robot_basics.feedback.rclpy_names import CLASSES, OWN_METHODS, OWN_PROPERTIES


class Case(NamedTuple):
    """A kind of exception, and a hint for it."""

    pattern: str
    """A regular expression to search for in the text of the exception."""
    to_do: str
    """A clause to append to that text."""


DECIMAL_COMMA = ', so a decimal comma may have made two numbers of one: write 0.2, and not 0,2'
BY_WORDS = (
    Case(
        pattern=rf"property '(?:{OWN_PROPERTIES})' of .* has no setter"
        '|handle cannot be modified after node creation'
        r"|'(?:str|int|float|bool|list|dict|tuple|function)' object has no attribute 'add_node'",
        to_do=', so choose another name: `Node` already has an attribute of this name, '
        'and uses it',
    ),
    Case(
        pattern=r"'rclpy\._rclpy_pybind11\.Node' object is not callable",
        to_do=', so give your method another name than `handle`: `Node` already has '
        'an attribute of this name',
    ),
    Case(
        pattern=rf'(?<!\bNode)\.(?:{OWN_METHODS})\(\) (?:takes|missing) '
        r"|no attribute '(?:info|warn|warning|error|debug|fatal)'.*self\.get_logger\(\)"
        r"|'NoneType' object has no attribute 'now'.*self\.get_clock\(\)",
        to_do=', so give your method another name: `Node` already has a method of this name, '
        'and uses it',
    ),
    Case(
        pattern=r"(?:function|method|partial)' object has no attribute 'add_entity'"  # 0,2, f
        r"|argument must be a string or a real number, not 'tuple'"  # period_sec = 0,2
        r"|could not convert string to float: '\d+[,，]\d"  # '0,2'
        r'|element \d+ at .*is not a ParameterDescriptor'  # declare_parameter('rate_hz', 5,0)
        r'|sleep\(\) takes exactly one argument \(2 given\)',
        to_do=DECIMAL_COMMA,
    ),
    Case(
        pattern=r'rclpy_resolve_name\(\): incompatible|has no .*_TYPE_SUPPORT',
        to_do=', so give the type first, such as JointState, and the name of the topic or service '
        'second',
    ),
    Case(
        pattern="missing 1 required positional argument: 'node_name'",
        to_do=", so give the node its name: super().__init__('…') in a method __init__",
    ),
    Case(pattern="requires a 'super' object", to_do=', so write super() with its parentheses'),
    Case(
        pattern="a real number, not 'method'|object has no attribute 'add_entity'",
        to_do=', so give create_timer the period first, the callback second, and no queue depth',
    ),
    Case(
        pattern="received <enum 'QoSPresetProfiles'>",
        to_do=', so take the profile out of the preset with .value',
    ),
    Case(
        pattern=r'AssertionError: line \d+: .*QoSProfile\(',
        to_do=', so give each policy as one, such as ReliabilityPolicy.BEST_EFFORT, and depth as '
        'a whole number',
    ),
    Case(
        pattern=r'rclpy_logging_rcutils_log\(\): incompatible|RcutilsLogger\.\w+\(\) takes 2',
        to_do=', so log a text: put the value into an f-string',
    ),
    Case(
        pattern=r"name '(?i:true|false|none|null)' is not defined",
        to_do=', so write True, False or None with a capital letter',
    ),
    Case(
        pattern=r"name '(?!(?:self|rospy)')\w+' is not defined(?: \(line |$)",
        to_do=', so import or define it first, or put it in quotes if it is a text',
    ),
    Case(
        pattern=r"operand type\(s\) for \^: |ufunc 'bitwise_xor'",
        to_do=', so write ** for a power, such as x**2',
    ),
    Case(
        pattern=r"operand type\(s\) for [&|]: |ufunc 'bitwise_(?:and|or)'",
        to_do=', so write the words `and` and `or` between comparisons, and not & and |',
    ),
    Case(
        pattern=r"'dict' object (?:has no attribute|is not callable)",
        to_do=", so write the key in quotes and square brackets: name['key']",
    ),
    Case(
        pattern=r'append\(\) takes exactly one argument',
        to_do=', so append one value at a time, or write extend([…])',
    ),
    Case(
        pattern=r"'(?:property|member_descriptor)' object has no attribute",
        to_do=', so make an object of the class with parentheses, such as JointState()',
    ),
    Case(
        pattern=r'(?:array|list) assignment index out of range',
        to_do=', so assign the whole list, [one, two], or append to it: an empty list has no '
        'first element',
    ),
    Case(
        pattern='must be real number, not (?:list|tuple|array)',
        to_do=', so convert each number by itself: [radians(angle) for angle in angles]; two '
        'arguments need no inner brackets: hypot(x, y)',
    ),
    Case(
        pattern="'float' object is not iterable",
        to_do=', so write a list, in square brackets, if several numbers are needed',
    ),
    Case(pattern='severity cannot be changed', to_do=', so log each level in a line of its own'),
    Case(pattern='raised StopIteration', to_do=', so start again when next(…) finds no more'),
    Case(pattern=r'too many values .* in \w+:\)', to_do=', so go through .items() of a dict'),
    Case(pattern="'await' outside async function", to_do=', so begin its function with async def'),
    Case(
        pattern="'(?:function|method)' object has no attribute",
        to_do=', so call it, with parentheses behind its name',
    ),
    Case(
        pattern="'list' object has no attribute|list indices must be integers or slices, not str",
        to_do=', so go through the list: for each in the_list',
    ),
    Case(
        pattern=r'(?:Request|Response|Goal|Feedback|Result|Range)\.__init__\(\) takes 1',
        to_do=', so write each field with its name, such as SolveIK.Request(target=point)',
    ),
    Case(
        pattern="'(?:JointState|Header|Point|String|Int32|\\w+_(?:Request|Response|Goal|Result"
        "|Feedback))' object has no attr",
        to_do=', so look its fields up with ros2 interface show',
    ),
    Case(
        pattern='ParameterNotDeclaredException: ',
        to_do=', so declare it first, with self.declare_parameter',
    ),
    Case(
        pattern=r"Range\(.* is not a ParameterDescriptor|'\w+Range' object is not subscriptable",
        to_do=', so put the range into a list, and that into a descriptor: '
        'ParameterDescriptor(floating_point_range=[…])',
    ),
    Case(
        pattern=r'Context\.init\(\) must only be called once',
        to_do=', so leave out rclpy.init(): it has been called already',
    ),
    Case(
        pattern='no signature found for builtin',
        to_do=', so put it into a function of your own, such as '
        'lambda message: kept.append(message)',
    ),
    Case(
        pattern="'NoneType' object does not support the context manager",
        to_do=', so call rclpy.init() in a line of its own: `with` cannot use what it returns',
    ),
    Case(
        pattern=rf'\b(?!(?:{CLASSES})\b)\w+\.(?!__)\w+\(\) takes \d+ positional arguments? but',
        to_do=', so write a parameter for each of them into its def, such as (self, request, '
        'response) for a service, (self, message) for a subscription, (self, future) for '
        'add_done_callback, and (self) for a timer',
    ),
    Case(
        pattern=r'callback should be either be callable',
        to_do=', so give it a function that takes one message, by its name and without '
        'parentheses; the def of a method begins with self: (self, message)',
    ),
    Case(
        pattern=r'service type provided is not valid',
        to_do=', so give the type of a service, such as SolveIK, and none of its parts',
    ),
    Case(
        pattern=r'message type provided is not valid',
        to_do=', so give the type of a message, such as JointState',
    ),
    Case(
        pattern='Service classes can not be instantiated',
        to_do=', so write its name without parentheses, or SolveIK.Request() for a request',
    ),
    Case(
        pattern=r"operand type\(s\) for [-/*]+: .*'str'",
        to_do=', so leave out the quotes around a number, or convert a text to one with float()',
    ),
)
"""The first case whose pattern is found is used."""
