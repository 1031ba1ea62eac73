"""Sentences of the course about checks, nodes and kernels, translated into Chinese."""

import pytest
from chinese_reason import CHINESE_REASON, REASON
from my_robot_basics.feedback.unanswered import say_stopped
from my_robot_basics.language import speaking
from my_robot_basics.language.sentences import REASON as REASON_FORM
from my_robot_basics.language.sentences import Sentences
from my_robot_basics.language.speaking import in_language


def test_a_reason_of_the_course_is_translated_into_chinese():
    assert in_language('zh_CN', REASON) == CHINESE_REASON
    assert in_language('en', REASON) == REASON


LONG = (
    'expected each text to define what its table says, saw something else in `turns_msg`: in '
    "`turns_msg`, the line 'int[2] turns': there is no type int: write int32 or another int with "
    "its number of bits; the line 'float[2] gear_ratios [100.0, 50.0]': there is no type float: "
    'write float64, or float32 for half the digits'
)
RAISED = (
    'expected messages on /kinematics/joint_states, saw no message in 2 s: /arm has a publisher '
    'there and sends nothing, because its callback raised TypeError: Arm.publish() takes 0 '
    'positional arguments but 1 was given, so write a parameter for each of them into its def, '
    'such as (self, request, response) for a service, (self, message) for a subscription, '
    '(self, future) for add_done_callback, and (self) for a timer'
)
WITH_COLONS = {
    'expected [0.5236, -1.5708] rad for (30.0, -90.0) degrees, saw [30.0, -90.0]: these are '
    'degrees: convert both with radians()': {
        'expected': '(30.0, -90.0) 度对应的 [0.5236, -1.5708] rad',
        'seen': '[30.0, -90.0]',
        'hint': '这些是度：两个都用 radians() 换算',
    },
    "expected only {'joint1': 0.5} for (30.0, -90.0) degrees, saw {'joint1': 30.0, 'joint2': "
    '-90.0}: joint2 is still in degrees: convert both with radians()': {
        'expected': "(30.0, -90.0) 度只对应 {'joint1': 0.5}",
        'seen': "{'joint1': 30.0, 'joint2': -90.0}",
        'hint': 'joint2 还是度：两个都用 radians() 换算',
    },
    'expected a message from /a to be republished on /b, unchanged, saw none in 1 s: its callback '
    "raised AttributeError: no 'send' (line 1, in f: self.send(m)); fix that first": {
        'expected': '来自 /a 的消息原样转发到 /b',
        'seen': '1 s 内没有',
        'hint': "它的回调抛出了 AttributeError: no 'send'（第 1 行，在 f 里：self.send(m)）；"
        '请先改正它',
    },
    'expected rate_hz = 5.0 to be set, saw it refused: `Wrong parameter type, expected '
    "'Type.INTEGER' got 'Type.DOUBLE'`: a parameter has the type of its default value: "
    'declare it with 5.0, not 5': {
        'expected': '设置 rate_hz = 5.0',
        'seen': "被拒绝了：`Wrong parameter type, expected 'Type.INTEGER' got 'Type.DOUBLE'`",
        'hint': '参数的类型就是默认值的类型：声明时写 5.0，不要写 5',
    },
    'expected `f(1)` to return a bool, saw an int (1): print(type(…)) of the value shows what it '
    'is': {
        'expected': '`f(1)` 返回 bool',
        'seen': 'int (1)',
        'hint': '对这个值用 print(type(…))，就能看到它是什么',
    },
    'expected use_sim_time, another parameter, to be set, saw it refused: `use 1 to 50 Hz. Min: '
    '1.0, max: 50.0`: change nothing when you refuse a value': {
        'expected': '设置另一个参数 use_sim_time',
        'seen': '被拒绝了：`use 1 to 50 Hz. Min: 1.0, max: 50.0`',
        'hint': '拒绝一个值时，什么也不要改变',
    },
    LONG: {
        'expected': '每个字符串都定义它的表格所说的内容',
        'seen': '`turns_msg` 里是别的内容',
        'hint': "`turns_msg` 里：这一行 'int[2] turns'：没有类型 int："
        "请写 int32，或者带有位数的其他 int；这一行 'float[2] gear_ratios [100.0, 50.0]'："
        '没有类型 float：请写 float64，或者位数减半的 float32',
    },
}


@pytest.mark.parametrize(('english', 'parts'), WITH_COLONS.items())
def test_a_reason_with_colons_is_split_into_expected_seen_and_hint(english, parts):
    assert speaking.sentences('zh_CN').parts(REASON_FORM, english) == parts
    assert in_language('zh_CN', english) == (
        '预期：{expected}；实际：{seen}。{hint}'.format(**parts)
    )


def test_a_sentence_that_is_not_a_reason_has_no_parts():
    assert speaking.sentences('zh_CN').parts(REASON_FORM, 'it ended') == {}


OF_THE_DOCTOR_AND_LIVE = {
    'All is well on /t: /a and /b publish, /c subscribes, 5 Hz (10 messages in 2.0 s).': (
        '/t 一切正常：/a 和 /b 发布，/c 订阅，5 Hz（2.0 s 内 10 条消息）。'
    ),
    'Something is wrong on /t: nobody publishes, /b subscribes, no new message in 2.0 s.': (
        '/t 有问题：没有节点发布，/b 订阅，2.0 s 内没有新消息。'
    ),
    'none, and /a publishes on /b (the namespace differs): in /a, a name without a leading / '
    "begins with the node's namespace": (
        '没有，而 /a 发布的是 /b（命名空间不同）：在 /a 里，'
        '不以 / 开头的名称前面会加上节点的命名空间'
    ),
    'Something is wrong on /t: /arm publishes, nobody subscribes, 1 message in 3.0 s.': (
        '/t 有问题：/arm 发布，没有节点订阅，3.0 s 内 1 条消息。'
    ),
    'a stamp 5.0 s ahead of it: tf2, RViz2 and message filters drop such messages': (
        '时间戳比发送时的时钟超前 5.0 s：tf2、RViz2 和 message filters 会丢弃这样的消息'
    ),
    'a stamp 0.2 s behind it: tf2, RViz2 and message filters drop such messages': (
        '时间戳比发送时的时钟落后 0.2 s：tf2、RViz2 和 message filters 会丢弃这样的消息'
    ),
    'it has been running for at least 6 s, and is in line 4: time.sleep(9); until it returns, the '
    "response of /ik can't be taken": (
        '它已经运行了至少 6 s，正停在第 4 行：time.sleep(9)；在它返回之前，/ik 的响应取不走'
    ),
    'it has been running for at least 6 s, and is in a line that is not known': (
        '它已经运行了至少 6 s，正停在某一行（不知道是哪一行）'
    ),
    'the callback ask of /waver to return, so that /arm can go on': (
        '/waver 的回调 ask 返回，这样 /arm 才能继续'
    ),
    'not written: there is no class Arm yet: run the cell in which you write it, then this one': (
        '没有写入：还没有类 Arm：先运行写有它的单元格，再运行这个'
    ),
    'not written: Waver does nothing yet: answer the exercise, run its cells, then this one '
    '(waver.py stays as it was)': (
        '没有写入：Waver 还什么都不做：先完成练习，运行它的单元格，再运行这个（waver.py 保持原样）'
    ),
    "greet: ended after SIGINT, but not cleanly (exit code 1, with KeyError: 'a'): catch "
    'KeyboardInterrupt and ExternalShutdownException in main': (
        "greet：在 SIGINT 之后结束，但不正常（退出码 1，最后是 KeyError: 'a'）：在 main 里捕获 "
        'KeyboardInterrupt 和 ExternalShutdownException'
    ),
    'the callback ask of /waver to return, so that its response is sent': (
        '/waver 的回调 ask 返回，这样它的响应才能发出'
    ),
    'none; /user asks it, and these run, too: /arm': '没有；/user 在请求它，还有这些在运行：/arm',
    'it raised an exception a moment ago (ValueError: no), and the goal was aborted': (
        '它刚才抛出了异常（ValueError: no），目标因此被中止'
    ),
    'a goal that was executing for at least 5 s, and no feedback': (
        '目标处于 executing 状态至少 5 s，而且没有反馈'
    ),
    'written  $ROS_WS/src/my_robot_basics/five_hz.py': (
        '已写入   $ROS_WS/src/my_robot_basics/five_hz.py'
    ),
    'reset: no node is running; now write IKService': (
        '已重置：没有节点在运行；IKService 由你来写'
    ),
    'NotRunnable: expected a class IKService, saw nothing of that name: run the answer cell, and '
    'if that ends in an error, fix that first': (
        'NotRunnable：预期：有类 IKService；实际：没有这个名称。'
        '运行答案单元格；如果它以错误告终，先改正错误'
    ),
}


@pytest.mark.parametrize(('english', 'chinese'), OF_THE_DOCTOR_AND_LIVE.items())
def test_sentences_of_topic_doctor_and_live_are_translated_into_chinese(english, chinese):
    assert in_language('zh_CN', english) == chinese


OF_CHECKS = {
    "the execute callback raised an exception ('A' object has no attribute 'b')": (
        "执行回调抛出了异常（'A' object has no attribute 'b'）"
    ),
    "it raised an exception a moment ago ('A' object has no attribute 'b'), and the goal was"
    ' aborted': "它刚才抛出了异常（'A' object has no attribute 'b'），目标因此被中止",
    '3 goals in place of 2': '发出了 3 个目标，而应当是 2 个',
    'the elbow-up pose (1.1, -1.2) on /pose': '肘上姿态，即 /pose 上的 (1.1, -1.2)',
    '0.50 Hz over 10 s (1 message)': '10 s 内为 0.50 Hz（1 条消息）',
    '7.0 Hz over 6 s (42 messages), and several messages at once': (
        '6 s 内（42 条消息），7.0 Hz，其中有几条消息同时到达'
    ),
    'pauses of 1.2 s over 6 s (24 messages)': '6 s 内（24 条消息），停顿长达 1.2 s',
    '(53.32, -119.5), which looks like degrees': '(53.32, -119.5)，看起来像是度',
    'your cell `a` did not end and was interrupted': '你的单元格 `a` 没有结束，已被中断',
    'no outcome while the server has not said how the goal ended': (
        '服务端还没有说目标怎样结束时，不发布结局'
    ),
    'a stamp 5.0 s ahead of it': '时间戳比发送时的时钟超前 5.0 s',
    'a stamp 0.2 s behind it': '时间戳比发送时的时钟落后 0.2 s',
    '1 message in 2.0 s': '2.0 s 内有 1 条消息',
    '12 messages in 2.0 s': '2.0 s 内有 12 条消息',
    "it has ended: exit code 1, ModuleNotFoundError: No module named 'x'": (
        "它已经结束：退出码 1，ModuleNotFoundError: No module named 'x'"
    ),
    'it has ended: ended by SIGKILL': '它已经结束：被 SIGKILL 结束',
    'ended by SIGINT, KeyboardInterrupt': '被 SIGINT 结束，KeyboardInterrupt',
    'it succeeded too soon': '太早就变为 succeeded',
    'it aborted in the end': '最后变为 aborted',
    'it accepted in 10 s': '10 s 之后状态为 accepted',
    '1 of the 2 that this part runs wrong': '这一部分实际运行的 2 个预测里有 1 个错误',
    '1 wrong, which leaves 1 of 2 points': '1 个错误，还剩 2 分中的 1 分',
    'a numpy object in it': '其中有 numpy object',
    'a numpy complex128': 'numpy complex128',
    'arm_driver to end after SIGINT': 'arm_driver 在 SIGINT 之后结束',
    'gear_ratios is of type float32: the table asks for another number of bits': (
        'gear_ratios 的类型是 float32：表格要求的位数不同'
    ),
    'turns takes any number of values, []: see how many the table asks for': (
        'turns 写的是任意多个值，[]：看看表格要求几个'
    ),
    'a point just beyond the outer border, l1 + l2, has to give False': (
        '紧靠外边界（l1 + l2）外侧的点，应该得到 False'
    ),
}


@pytest.mark.parametrize(('english', 'chinese'), OF_CHECKS.items())
def test_observations_of_checks_are_translated_into_chinese(english, chinese):
    assert in_language('zh_CN', english) == chinese


COUNTED = (
    'expected 2 publishers, saw 4 (motor_guard, pose_logger, self_test, tool_tracker): read the '
    'names in ros2 topic info --verbose /kinematics/joint_states'
)


OF_STUDENTS = {
    'expected elbow_up of [1.1, -1.2] rad for the target (1, 2), saw [1.0, 2.0]: keep both keys': (
        '预期：目标点 (1, 2) 的 elbow_up 为 [1.1, -1.2] rad；实际：[1.0, 2.0]。两个键都要保留'
    ),
    'expected reachable to be True for the target (1, 2) with z = 0.7, saw False: z does not '
    'matter: look at x and y of the target alone': (
        '预期：z = 0.7 的目标点 (1, 2) 的 reachable 为 True；实际：False。'
        'z 无关紧要：只看目标点的 x 和 y'
    ),
    '`late` arrives (a topic takes any number of publishers); `other_type` does not arrive (name '
    'and type must both be equal)': (
        '`late` 能收到（一个话题可以有任意多个发布者）；'
        '`other_type` 收不到（名称和类型都必须相同）'
    ),
    "colcon does not build a: setup.py, line 7: NameError: name 'x' is not defined: fix that, and "
    'build again': (
        "colcon 没有编译 a：setup.py，第 7 行：NameError: name 'x' is not defined："
        '先改正，再重新编译'
    ),
    'your cell `a` ended the kernel: your code sent it SIGKILL': (
        '你的单元格 `a` 使内核终止：你的代码向它发送了 SIGKILL'
    ),
    'what you started has ended: your code used more than 2,048 MB': (
        '你启动的东西已经结束：你的代码使用的内存超过了 2,048 MB'
    ),
    'expected an answer from `f`, saw no answer within 5 s; at grading it has 10 s: keep both '
    'keys': ('预期：`f` 的回答；实际：5 s 内没有回答；评分时有 10 s。两个键都要保留'),
    'expected an answer from `f`, saw no answer: your code sent over 32 MB at once, or closed a '
    'connection of its kernel, which was ended: nothing that it says could be received any more: '
    'keep both keys': (
        '预期：`f` 的回答；实际：没有回答：你的代码一次发送了超过 32 MB，或者关闭了内核的'
        '一个连接，因此内核已被终止：它再说什么也收不到了。两个键都要保留'
    ),
    'arm_interfaces in /ws was built for Python 3.11, and this is Python 3.12: build it again, '
    'with `cd /ws && colcon build --packages-select arm_interfaces`': (
        '/ws 里的 arm_interfaces 是为 Python 3.11 编译的，而这里是 Python 3.12：请再编译一次，用 '
        '`cd /ws && colcon build --packages-select arm_interfaces`'
    ),
    "your cell `a` stopped with SyntaxError: expected ':' (line 15)": (
        "你的单元格 `a` 停止了：SyntaxError: expected ':'（第 15 行）"
    ),
    'your cell `a` stopped with SyntaxError: invalid syntax (line 1: if a, b && c:), so write the '
    'words `and`, `or` and `not`': (
        '你的单元格 `a` 停止了：SyntaxError: invalid syntax（第 1 行：if a, b && c:），'
        '请写单词 `and`、`or` 和 `not`'
    ),
    'your cell `a` stopped with IndentationError: expected an indented block after function '
    'definition on line 1 (line 2)': (
        '你的单元格 `a` 停止了：IndentationError: expected an indented block after function '
        'definition on line 1（第 2 行）'
    ),
    "your cell `a` stopped with SyntaxError: invalid character '，' (U+FF0C) (line 3)": (
        "你的单元格 `a` 停止了：SyntaxError: invalid character '，' (U+FF0C)（第 3 行）"
    ),
    "expected `f(1)` to return, saw TypeError: f() missing 1 required positional argument: 'l2': "
    'call f(1) in a cell of your own to see where': (
        '预期：`f(1)` 会返回；实际：TypeError: f() missing 1 required positional argument: '
        "'l2'。在你自己的单元格里调用 f(1)，看看是在哪里"
    ),
    "expected `f(1)` to return, saw TypeError: unsupported operand type(s) for ^: 'float' and "
    "'float': call f(1) in a cell of your own to see where": (
        "预期：`f(1)` 会返回；实际：TypeError: unsupported operand type(s) for ^: 'float' and "
        "'float'。在你自己的单元格里调用 f(1)，看看是在哪里"
    ),
    "expected `f(1)` to return, saw it raised `AttributeError: 'property' object has no attribute "
    "'stamp'`, so make an object of the class with parentheses, such as JointState(): call `f(1)` "
    'in a cell of your own to see where': (
        "预期：`f(1)` 会返回；实际：它抛出了 `AttributeError: 'property' object has no attribute "
        "'stamp'`，请在类名后面加圆括号来创建对象，例如 JointState()。在你自己的单元格里调用 "
        '`f(1)`，看看是在哪里'
    ),
    "expected `f(1)` to return, saw it raised `TypeError: 'float' object is not iterable`, so "
    'write a list, in square brackets, if several numbers are needed: call `f(1)` in a cell of '
    'your own to see where': (
        "预期：`f(1)` 会返回；实际：它抛出了 `TypeError: 'float' object is not iterable`，"
        '需要多个数的地方，请写成列表，用方括号括起来。在你自己的单元格里调用 '
        '`f(1)`，看看是在哪里'
    ),
    'in the part checked at grading: `f` raises NotImplementedError: call … in a cell of your own '
    'to see where': (
        '在评分时检查的部分：`f` 抛出 NotImplementedError：在你自己的单元格里调用 …，看看是在哪里'
    ),
    "its callback raised AttributeError: 'float' object has no attribute 'sec' (line 4, in f: "
    'p.publish(m)), so give `header.stamp` a value of the type `builtin_interfaces/Time`': (
        "它的回调抛出了 AttributeError: 'float' object has no attribute 'sec'（第 4 行，在 f 里："
        'p.publish(m)），应当给 `header.stamp` 一个 `builtin_interfaces/Time` 类型的值'
    ),
    'its callback raised KeyboardInterrupt (line 9, in f: raise KeyboardInterrupt); fix that '
    'first': (
        '它的回调抛出了 KeyboardInterrupt（第 9 行，在 f 里：raise KeyboardInterrupt）；请先改正它'
    ),
    'your cell `a` stopped with InvalidNodeNameException: Invalid node name: node name must not '
    "contain characters other than alphanumerics or '_': 'my-node' ^": (
        '你的单元格 `a` 停止了：InvalidNodeNameException: Invalid node name: node name must not '
        "contain characters other than alphanumerics or '_': 'my-node' ^"
    ),
    'your cell `a` stopped with InvalidTopicNameException: Invalid topic name: topic name must '
    "not contain characters other than alphanumerics, '_', '~', '{', or '}': '／a', so write '/' "
    "in place of '／', a full-width character": (
        '你的单元格 `a` 停止了：InvalidTopicNameException: Invalid topic name: topic name must '
        "not contain characters other than alphanumerics, '_', '~', '{', or '}': '／a'，"
        "请把全角字符 '／' 改写成 '/'"
    ),
    'its callback raised InvalidNodeNameException: Invalid node name: node name must not contain '
    "characters other than alphanumerics or '_': 'a b' (line 4, in f: g(x)), so write a name of "
    'letters from a to z, digits and _ alone': (
        '它的回调抛出了 InvalidNodeNameException: Invalid node name: node name must not contain '
        "characters other than alphanumerics or '_': 'a b'（第 4 行，在 f 里：g(x)），"
        '名称只能用 a 到 z 的字母、数字和 _，请改写'
    ),
    "expected a warning in the log of /a, saw 'IK: x=1, y=2': keep both keys": (
        "预期：/a 的日志里有一条警告；实际：'IK: x=1, y=2'。两个键都要保留"
    ),
    'in the part checked at grading: a wrong message on /a/b: publish the angles of the response, '
    'not a solution of your own': (
        '在评分时检查的部分：/a/b 上的消息不对：发布响应里的角度，而不是你自己的解'
    ),
    'expected `f(1)` to return a bool, saw an int (1): keep both keys': (
        '预期：`f(1)` 返回 bool；实际：int (1)。两个键都要保留'
    ),
    "its callback raised TypeError: 'NoneType' object is not callable, so give a method by its "
    'name, without parentheses': (
        "它的回调抛出了 TypeError: 'NoneType' object is not callable，"
        '给出方法时只写名字，不加圆括号'
    ),
}


WITH_LINES = {
    'a thread of the notebook raised ValueError: no (arm.py, line 12, in publish: send(1))': (
        'notebook 的一个线程抛出了 ValueError: no（arm.py，第 12 行，在 publish 里：send(1)）'
    ),
    'it raised an exception a moment ago (KeyError: 0 (line 7, in publish: ENDS[publish(0)])), '
    'and the goal was aborted': (
        '它刚才抛出了异常（KeyError: 0（第 7 行，在 publish 里：ENDS[publish(0)]）），'
        '目标因此被中止'
    ),
    'it raised NoPose: no message (line 12, in publish: raise NoPose): no response was sent': (
        '它抛出了 NoPose: no message（第 12 行，在 publish 里：raise NoPose）：没有发出响应'
    ),
    'expected 5.0 Hz, saw none in 3 s: its callback raised ValueError: no (line 12, in '
    'publish: self.send(JointState(); fix that first': (
        '预期：5.0 Hz；实际：3 s 内没有。它的回调抛出了 ValueError: no（第 12 行，在 publish 里：'
        'self.send(JointState(）；请先改正它'
    ),
    'it raised an exception a moment ago (KeyError: 0 (line 7, in publish: 2: send([service])), '
    'and the goal was aborted': (
        '它刚才抛出了异常（KeyError: 0（第 7 行，在 publish 里：2: send([service]）），'
        '目标因此被中止'
    ),
    "your cell `a` stopped with SyntaxError: '(' was never closed (line 3: publish(x)": (
        "你的单元格 `a` 停止了：SyntaxError: '(' was never closed（第 3 行：publish(x）"
    ),
    "your cell `a` stopped with SyntaxError: unmatched ')' (line 3: publish(x)))": (
        "你的单元格 `a` 停止了：SyntaxError: unmatched ')'（第 3 行：publish(x))）"
    ),
    'your cell `a` stopped with SyntaxError: unterminated string literal (detected at line 3) '
    "(line 3: node = 'message)": (
        '你的单元格 `a` 停止了：SyntaxError: unterminated string literal (detected at line 3)'
        "（第 3 行：node = 'message）"
    ),
    'its callback has not returned (line 12, in publish: send(message, service))': (
        '它的回调还没有返回（第 12 行，在 publish 里：send(message, service)）'
    ),
    'its callback has not returned (line 12: publish)': '它的回调还没有返回（第 12 行：publish）',
    'a callback sleeps in line 4 (sleep(period); publish), and meanwhile the timer cannot call '
    'anything: leave the sleep out': (
        '有一个回调在第 4 行休眠（sleep(period); publish），这期间定时器什么也调用不了：'
        '请去掉这个休眠调用'
    ),
    'your cell `a` stopped with AssertionError: line 12: assert publish, message': (
        '你的单元格 `a` 停止了：AssertionError：第 12 行：assert publish, message'
    ),
    '(line 12, in publish: message)': '（第 12 行，在 publish 里：message）',
    '(line 12, in <module>: publish(service); message.data = 1)': (
        '（第 12 行，在 <module> 里：publish(service); message.data = 1）'
    ),
}


@pytest.mark.parametrize(('english', 'chinese'), WITH_LINES.items())
def test_the_place_of_an_error_is_translated_and_its_function_and_code_are_not(english, chinese):
    assert in_language('zh_CN', english) == chinese


@pytest.mark.parametrize(('english', 'chinese'), OF_STUDENTS.items())
def test_names_and_code_of_students_stay_whole_in_chinese_sentences(english, chinese):
    assert in_language('zh_CN', english) == chinese


def test_a_number_of_publishers_or_subscriptions_is_translated_into_chinese():
    shown = in_language('zh_CN', COUNTED)
    assert shown.startswith('预期：2 个发布者；实际：4')
    assert in_language('zh_CN', 'expected 4 subscriptions, saw 0 (no name): keep both keys') == (
        '预期：4 个订阅；实际：0（没有名字）。两个键都要保留'
    )


@pytest.mark.parametrize(
    ('error', 'chinese'),
    [
        (
            "SyntaxError: invalid character '：' (U+FF1A)",
            "它抛出了 `SyntaxError: invalid character '：' (U+FF1A)`，请改写成 ':'",
        ),
        (
            'IndentationError: unexpected indent',
            '它抛出了 `IndentationError: unexpected indent`，请让同一个代码块的每一行都以同样多的'
            '空格开头',
        ),
        ('SyntaxError: invalid syntax', '`SyntaxError: invalid syntax`'),
    ],
)
def test_what_stopped_an_answer_cell_is_told_in_chinese_with_its_hint(error, chinese):
    assert in_language('zh_CN', say_stopped('motion', error)) == (
        f'预期：答案单元格 `motion` 运行到结束；实际：{chinese}。请改正 `motion` 并运行它，'
        '然后再运行这个单元格'
    )


def test_another_thread_that_translates_does_not_prolong_a_search(monkeypatch):
    """A node's thread may tell an exception many times a second while a check fails."""
    chinese, put, puts = speaking.sentences('zh_CN'), Sentences._put, []
    monkeypatch.setattr(Sentences, '_put', lambda *given: puts.append(0) or put(*given))
    shown = chinese.translate(RAISED)
    alone = len(puts)

    def disturbed(*given):
        puts.append(0)
        assert len(puts) <= 2 * alone
        if len(puts) % 20 == 0:
            with monkeypatch.context() as other_thread:
                other_thread.setattr(Sentences, '_put', put)
                assert chinese.translate('nobody knows this') == 'nobody knows this'
        return put(*given)

    puts.clear()
    monkeypatch.setattr(Sentences, '_put', disturbed)
    assert chinese.translate(RAISED) == shown
    assert len(puts) == alone
