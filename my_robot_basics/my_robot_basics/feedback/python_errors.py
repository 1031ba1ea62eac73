"""What to do about exceptions of Python and rclpy whose own words do not tell beginners."""

import re
import unicodedata

_TWO_NUMBERS = re.compile(
    r"object has no attribute 'add_entity'"  # create_timer(0,2, …) takes the callback for a group
    r"|argument must be a string or a real number, not 'tuple'"  # period_sec = 0,2
    r"|could not convert string to float: '\d+[,，]\d"  # '0,2'
    r'|element [-\d.]+ .*is not a ParameterDescriptor'  # declare_parameter('rate_hz', 5,0)
    r'|sleep\(\) takes exactly one argument \(2 given\)'
)
DECIMAL_COMMA = ', so a decimal comma may have made two numbers of one: write 0.2, and not 0,2'
_BY_WORDS = (
    (_TWO_NUMBERS, DECIMAL_COMMA),
    (
        re.compile(r'rclpy_resolve_name\(\): incompatible|has no .*_TYPE_SUPPORT'),
        ', so give the type first, such as JointState, and the name of the topic or service '
        'second',
    ),
    (
        re.compile("missing 1 required positional argument: 'node_name'"),
        ", so give the node its name: super().__init__('…') in a method __init__",
    ),
    (re.compile("requires a 'super' object"), ', so write super() with its parentheses'),
    (
        re.compile("a real number, not 'method'"),
        ', so give create_timer the period first, and the callback second',
    ),
    (
        re.compile("received <enum 'QoSPresetProfiles'>"),
        ', so take the profile out of the preset with .value',
    ),
    (
        re.compile(r'AssertionError: line \d+: .*QoSProfile\('),
        ', so give each policy as one, such as ReliabilityPolicy.BEST_EFFORT, and depth as a '
        'whole number',
    ),
    (
        re.compile(r'rclpy_logging_rcutils_log\(\): incompatible'),
        ', so log a text: put the value into an f-string',
    ),
    (
        re.compile(r"name '(?i:true|false|none|null)' is not defined"),
        ', so write True, False or None with a capital letter',
    ),
    (
        re.compile(r"name '\w+' is not defined$"),
        ', so import or define it first, or put it in quotes if it is a text',
    ),
    (
        re.compile(r"operand type\(s\) for \^: |ufunc 'bitwise_xor'"),
        ', so write ** for a power, such as x**2',
    ),
    (
        re.compile(r"operand type\(s\) for [&|]: |ufunc 'bitwise_(?:and|or)'"),
        ', so write the words `and` and `or` between comparisons, and not & and |',
    ),
    (
        re.compile(r"'dict' object (?:has no attribute|is not callable)"),
        ", so write the key in quotes and square brackets: name['key']",
    ),
    (
        re.compile(r'append\(\) takes exactly one argument'),
        ', so append one value at a time, or write extend([…])',
    ),
    (
        re.compile(r"'(?:property|member_descriptor)' object has no attribute"),
        ', so make an object of the class with parentheses, such as JointState()',
    ),
    (
        re.compile(r'(?:array|list) assignment index out of range'),
        ', so assign the whole list, [one, two], or append to it: an empty list has no first '
        'element',
    ),
    (
        re.compile('must be real number, not (?:list|tuple)'),
        ', so convert each number by itself: [radians(angle) for angle in angles]',
    ),
    (
        re.compile("'float' object is not iterable"),
        ', so write a list, in square brackets, where several numbers are wanted',
    ),
    (
        re.compile("'await' outside async function"),
        ', so begin its function with async def',
    ),
    (
        re.compile(r"operand type\(s\) for \S+: .*'Parameter'"),
        ', so take the value out of the parameter with .value',
    ),
    (
        re.compile(r"'NoneType' object has no attribute .*\.result\(\)"),
        ', so let add_done_callback call this function: call_async returns before the answer is '
        'there',
    ),
    (
        re.compile("'Future' object has no attribute"),
        ', so take the answer out of the future with .result()',
    ),
    (
        re.compile("'(?:function|method)' object has no attribute"),
        ', so call it, with parentheses behind its name',
    ),
    (
        re.compile("'list' object has no attribute"),
        ', so go through the list: for each in the_list',
    ),
    (
        re.compile(r'\w\.\w+\(\) missing \d+ required positional argument'),
        ', so give a callback by its name, without parentheses',
    ),
    (
        re.compile(r'_(?:Request|Response|Goal|Result|Feedback)\.__init__\(\) takes 1 positional'),
        ', so write each field with its name, such as SolveIK.Request(target=point)',
    ),
    (
        re.compile("_(?:Request|Response|Goal|Result|Feedback)' object has no attribute"),
        ', so look its fields up with ros2 interface show',
    ),
    (
        re.compile('ParameterNotDeclaredException: '),
        ', so declare it first, with self.declare_parameter',
    ),
    (
        re.compile(
            r"Range\(.* is not a ParameterDescriptor|'\w+Range' object is not subscriptable"
        ),
        ', so put the range into a list, and that into a descriptor: '
        'ParameterDescriptor(floating_point_range=[…])',
    ),
    (
        re.compile(r'Context\.init\(\) must only be called once'),
        ', so leave out rclpy.init(): it has been called already',
    ),
    (
        re.compile('no signature found for builtin'),
        ', so put it into a function of your own, such as lambda message: kept.append(message)',
    ),
    (
        re.compile("'NoneType' object does not support the context manager"),
        ', so call rclpy.init() in a line of its own: no with takes what it returns',
    ),
)
"""What to do, by the words of rclpy's or Python's own sentence."""
_NAME = re.compile(
    r'Invalid (?P<kind>node|topic|service|)[^:]*: \w+( name)? must not contain characters other '
    r"than [^:]*:\s+'(?P<name>.*?)'(?P<caret>\s+\^)"
)
"""How rcl refuses a name, with the place of what it refuses in a line below."""
_CHARACTER = re.compile(r"invalid (?:character '(.)' \(|non-printable character )U\+")
_MARKS = {
    **dict.fromkeys('‘’‚‛′', "'"),
    **dict.fromkeys('“”„‟″', '"'),
    **dict.fromkeys('‐‑‒–—−', '-'),
    **{'。': '.', '、': ',', '【': '[', '】': ']', '《': '<', '》': '>', '×': '*', '÷': '/'},
}
"""What a word processor, or a keyboard of another language, has in place of what Python reads."""


def explained(told: str) -> str:
    """A sentence or clause that tells what was raised, with what to do behind it, if anything."""
    why = what_to_do(told)
    if found := _NAME.search(told):  # in one line its caret points nowhere
        told = told[: found.start('caret')] + told[found.end('caret') :]
    return told.rstrip('.') + why if why else told


def what_to_do(said: str) -> str:
    """A clause to put behind what was raised, such as 'AttributeError: …'; or ''."""
    if found := _CHARACTER.search(said):
        return _about_character(found[1])
    if found := _NAME.search(said):
        return _about_name(found['name'], is_node=found['kind'] == 'node')
    return next((clause for words, clause in _BY_WORDS if words.search(said)), '')


def _about_character(character: str | None) -> str:
    """Which character to type in place of this one; None is one that shows nothing."""
    if character is None:
        return ', so type that line again: it has a space of another kind, as copied text may have'
    plain = _MARKS.get(character) or unicodedata.normalize('NFKC', character)
    is_wide = unicodedata.east_asian_width(character) == 'F' and plain.isascii()
    return f', so write {plain!r} in its place' if is_wide or character in _MARKS else ''


def _about_name(name: str, *, is_node: bool) -> str:
    """Which characters a name of ROS takes in place of those that it has."""
    strange = re.search(r'\W' if is_node else r'[^\w/~{}]', name, re.ASCII)
    plain = unicodedata.normalize('NFKC', strange[0]) if strange else ''
    if strange and re.fullmatch(r'\w' if is_node else r'[\w/~{}]', plain, re.ASCII):
        return f', so write {plain!r} in place of {strange[0]!r}, a full-width character'
    if is_node:
        return ', so write a name of letters from a to z, digits and _ alone'
    return ', so write a name of letters from a to z, digits, _ and / alone'
