"""Failures of checks have no English words left in Chinese, whatever values they quote.

Each `fail(expected=…, seen=…, hint=…)` of the code is translated with values that are not words.
"""

import ast
import re
from collections import defaultdict
from itertools import islice

from my_robot_basics.language.sentences import REASON
from my_robot_basics.language.speaking import in_language

from grader.course import ROOT

SOURCES = sorted((ROOT / 'my_robot_basics/my_robot_basics').rglob('*.py'))
PARTS = ('expected', 'seen', 'hint')
FAIL = {'fail', 'expect'}
MOST_TEXTS, MOST_DEEP = 8, 6
NAME, NUMBER = 'arm_1', '7'
"""They stand in for values that the code does not show."""
IS_NUMBER = re.compile(
    r'.*(sec|hz|count|number|length|len|size|points|earned|round|far|abs|deg|rad|ran|most|max|min'
    r'|exit_code|copies|speed|asked|answered|times|hours).*|x|y|n',
    re.IGNORECASE,
)
CODE = re.compile(
    r'`[^`]*`|\'[^\']*\'|"[^"]*"|--[\w-]+|\{[^}]*\}|[\w…]*[/_.(=\[:][^\s，。；：（）]*'
)
"""Text that is not translated: quotations, options, paths, names with a _ or a dot, calls."""
WORD = re.compile(r'(?<![A-Za-z])[a-z]{2,}(?![A-Za-z\d])')  # joint1 is a name
NAMES = {
    *('rad', 'notebook', 'rcl', 'rclpy', 'colcon', 'logger', 'main', 'time', 'call', 'return'),
    *('nan', 'string', 'wstring', 'liveliness', 'remaining', 'reachable', 'targets'),
    *('name', 'position', 'header', 'future'),
    *('succeeded', 'canceled', 'aborted'),
}
"""Words of ROS, Python and the lessons that are the same in each language."""


def name_of(node):
    return getattr(node, 'id', getattr(node, 'attr', ''))


def functions(tree):
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def assigned(nodes):
    """Return all expressions that are assigned to a name there."""
    found = defaultdict(list)
    for node in nodes:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            pairs = [(target, node.value)]
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                pairs = zip(target.elts, node.value.elts, strict=False)
            for one, value in pairs:
                if isinstance(one, ast.Name):
                    found[one.id].append(value)
    return found


def given(tree):
    """Return the arguments that calls in a module pass to its functions, by parameter."""
    found = defaultdict(lambda: defaultdict(list))
    known = {function.name: function.args for function in functions(tree)}
    for call in ast.walk(tree):
        if isinstance(call, ast.Call) and (args := known.get(name := name_of(call.func))):
            names = [arg.arg for arg in args.args if arg.arg not in ('self', 'cls')]
            pairs = [*zip(names, call.args, strict=False)]
            for parameter, value in [*pairs, *((each.arg, each.value) for each in call.keywords)]:
                found[name][parameter].append(value)
    return found


class Said:
    """The texts that expressions of some modules may have as their value."""

    def __init__(self, trees):
        self._returned = defaultdict(list)
        self._constants = {}
        self.functions = []
        for tree in trees:
            of_module, of_calls = assigned(tree.body), given(tree)
            self._constants |= of_module
            for function in functions(tree):
                here = of_module | assigned(ast.walk(function)) | of_calls[function.name]
                self.functions.append((function, here))
                if name_of(function.returns) == 'str':
                    returns = [n for n in ast.walk(function) if isinstance(n, ast.Return)]
                    self._returned[function.name] += [(each.value, here) for each in returns]

    def texts(self, node, here, deep=0):
        """Return a few texts that an expression may be; `here` is what is assigned around it."""
        if deep > MOST_DEEP:
            return [NAME]
        found = dict.fromkeys(self._texts(node, here, deep + 1))
        return [*islice(found, MOST_TEXTS)] or [NUMBER if IS_NUMBER.match(name_of(node)) else NAME]

    def _texts(self, node, here, deep):
        pairs = []
        match node:
            case ast.Constant(value=value):
                return [str(value)]
            case ast.JoinedStr(values=parts):
                return self._joined(parts, here, deep)
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return self._joined([left, right], here, deep)
            case ast.FormattedValue(value=value):
                return self.texts(value, here, deep)
            case ast.IfExp(body=one, orelse=other):
                pairs = [(one, here), (other, here)]
            case ast.BoolOp(values=values):
                pairs = [(value, here) for value in values]
            case ast.Subscript(value=ast.Name(id=name)):
                dicts = [each for each in self._of(name, here) if isinstance(each, ast.Dict)]
                pairs = [(value, here) for each in dicts for value in each.values]
            case ast.Name(id=name):
                others = {key: value for key, value in here.items() if key != name}
                pairs = [(value, others) for value in self._of(name, here)]
            case ast.Call(func=ast.Name(id='student_text' | 'shorten'), args=[first, *_]):
                pairs = [(first, here)]
            case ast.Call(func=function):
                pairs = self._returned.get(name_of(function), [])
                if not pairs and IS_NUMBER.match(name_of(function)):
                    return [NUMBER]
        return [text for value, there in pairs for text in self.texts(value, there, deep)]

    def _of(self, name, here):
        return here.get(name) or self._constants.get(name, [])

    def _joined(self, parts, here, deep):
        """Yield a text of several parts; each part varies while the others do not."""
        each = [self.texts(part, here, deep) for part in parts]
        first = [texts[0] for texts in each]
        yield ''.join(first)
        for at, texts in enumerate(each):
            for text in texts[1:]:
                yield ''.join([*first[:at], text, *first[at + 1 :]])


def reasons():
    """Return the reasons that checks may give for a failure, and in which function."""
    said, found = Said(ast.parse(path.read_text(encoding='utf-8')) for path in SOURCES), {}
    for function, here in said.functions:
        for call in ast.walk(function):
            told = {each.arg: each.value for each in getattr(call, 'keywords', [])}
            if name_of(getattr(call, 'func', None)) in FAIL and told.keys() >= {*PARTS}:
                each = {part: said.texts(told[part], here) for part in PARTS}
                first = {part: max(texts, key=bool) for part, texts in each.items()}
                for part, texts in each.items():
                    for text in texts:
                        if text and not text.startswith(
                            (',', ';')
                        ):  # such a text is the end of another one
                            reason = REASON.format(**(first | {part: text}))
                            found.setdefault(reason, function.name)
    return found


def english_in(shown):
    """Return the words that are left, or the whole text if it was not recognized as a reason."""
    if not re.fullmatch('预期：.+；实际：.+。.+', shown):
        return [shown]
    return [word for word in WORD.findall(CODE.sub(' ', shown)) if word not in NAMES]


def test_no_failure_keeps_words_in_english():
    said = reasons()
    assert len(said) > 400
    left = {reason: english_in(in_language('zh_CN', reason)) for reason in said}
    assert {(said[reason], reason): words for reason, words in left.items() if words} == {}


def test_english_words_that_are_left_in_a_translation_are_found():
    assert english_in('预期：`f(x)` 返回 /a_b；实际：3 rad。用 f(the_arm) 和 --ros-args') == []
    assert english_in('预期：一条消息；实际：none in 3 s。检查名称') == ['none', 'in']
    assert english_in('预期，一条消息，实际个错误 1') == ['预期，一条消息，实际个错误 1']


def test_advice_that_follows_a_topic_still_follows_the_topic_in_chinese():
    advice = 'publish exactly the message that your callback is given'
    for cause in 'no message arrives', 'only other messages arrive':
        said = in_language('zh_CN', f'{cause} on /monitor/joint_states: {advice}')
        assert said.startswith('/monitor/joint_states 上')
        assert said.endswith(f'：{in_language("zh_CN", advice)}')
