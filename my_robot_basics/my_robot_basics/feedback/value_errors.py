"""Hints for values of a wrong type, in messages' arrays and in parameters; as error_words."""

from my_robot_basics.feedback.error_words import Case

OF_VALUES = (
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
        pattern='must be real number, not str',
        to_do=', so give a number, and no text; a loop over a dict, or unpacking it, gives its '
        'keys and not its values',
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
