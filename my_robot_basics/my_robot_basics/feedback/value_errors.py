"""Hints for values of a wrong type: of arrays, parameters, durations; as in error_words."""

from my_robot_basics.feedback.error_words import Case

OF_VALUES = (
    Case(
        # if it is a whole number, error_words takes it for the second part of 5,0
        pattern='is not a ParameterDescriptor',
        to_do=", so give the name and the value alone, such as declare_parameter('rate_hz', 5.0): "
        'a third argument has to be a ParameterDescriptor',
    ),
    Case(
        pattern=r"'ParameterValue'|not ParameterValue\b",
        to_do=', so write .value in place of .get_parameter_value()',
    ),
    Case(
        pattern=r"(?:operand type\(s\) for|not supported between instances of) .*'Parameter'"
        r"|real number, not '?Parameter\b|type Parameter doesn't|'Parameter' object has no attr",
        to_do=', so take the value out of the parameter with .value',
    ),
    Case(
        pattern=r"'Duration' object has no attribute '(?:to_|total_)?sec"
        r"|(?:operand type\(s\) for|not supported between instances of) [^(]*'Duration'",
        to_do=', so take the seconds out of the duration with .nanoseconds / 1e9',
    ),
    Case(
        pattern=r"'\w*(?:Error|Exception)' object has no attribute '(?:message|msg|text|what)'",
        to_do=', so take its text with str(), such as str(error)',
    ),
    Case(
        # message.position is an array.array, and += and + take no list
        pattern=r'can only (?:extend|append) array|can only concatenate list \(not "array',
        to_do=', so append one value at a time, or assign the whole list: '
        'message.position = [one, two]',
    ),
    Case(
        # such as [], which rclpy takes for an array of bytes
        pattern="of type 'DOUBLE_ARRAY', expecting type",
        to_do=', so declare it with doubles, such as [0.0, 0.0]: its type is that of its '
        'default value',
    ),
    Case(
        pattern='is not a list of one of the allowed types',
        to_do=', so write numbers of one type in a single list, such as [0.0, 0.0]',
    ),
    Case(
        pattern="'Parameter' object is not (?:subscriptable|iterable)",
        to_do=", so get its value: self.get_parameter('…').value",
    ),
    Case(
        pattern='must be real number, not str|cannot use a str to initialize an array',
        to_do=', so give a number, and no text; a loop over a dict, or unpacking it, gives its '
        'keys and not its values',
    ),
    Case(
        # the clock of checks is a parameter, too, and False as a number is 0
        pattern=r'ZeroDivisionError: .*\(line .*/ \w+\.value',
        to_do=', so look at the name of the parameter first: the callback gets each parameter '
        'that is set, also use_sim_time, which is False',
    ),
    Case(
        pattern=r"'NoneType' object is not iterable \(line .* = None\)",
        to_do=', so write [] for a field that is a list without values',
    ),
    Case(
        # a field was assigned to the class, which spoils all its objects
        pattern=r"'[A-Z]\w*' object attribute '\w+' is read-only",
        to_do=', so make an object of the class with parentheses, such as JointState(), and '
        'restart the kernel: an assignment has changed the class itself',
    ),
    Case(
        # count += 1 has another reason
        pattern=r"local variable '(\w+)' where it is not associated(?!.*\b\1 ?[-+*/]=)",
        to_do=', so give it a value before this line in each case, or return earlier, such as at '
        'the end of `except`',
    ),
    Case(
        pattern='m from the base, too (?:far|near)',
        to_do=', so catch it: call inverse_kinematics after `try`, and write after '
        '`except ValueError` what happens then',
    ),
)
