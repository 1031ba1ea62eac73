"""What `live` promises, in real notebook kernels."""

import contextlib
import os
import queue
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import rclpy
from jupyter_client.manager import start_new_kernel
from rclpy.node import Node

TALKER = """
from my_robot_basics.live import follow_arm, reset, run, run_answer, show_arm, stop
from my_robot_basics.session import classroom
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self, text='x', period_sec=0.05):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, '/talk', 10)
        self.get_logger().info(f'made with {text}\\nin two lines')
        self.text, self.count = text, 0
        self.create_timer(period_sec, self.tick)

    def tick(self):
        self.count += 1
        self.publisher.publish(String(data=self.text))

def publishers(topic_name='/talk'):
    watcher = rclpy.create_node('_watcher')
    names = [info.node_name for info in watcher.get_publishers_info_by_topic(topic_name)]
    watcher.destroy_node()
    return names

def alive(node):
    import time
    before, deadline = node.count, time.monotonic() + 10
    while node.count < before + 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    return node.count >= before + 2

def frozen(node):
    import time
    before = node.count
    time.sleep(0.3)
    return node.count == before
"""


class Lesson:
    """A kernel, and the outputs of each cell that it has run."""

    def __init__(self, *setup):
        # ipykernel's debugger may else write a warning of its own to stderr as it starts
        env = os.environ | {'PYDEVD_DISABLE_FILE_VALIDATION': '1'}
        self.manager, self.client = start_new_kernel(
            kernel_name='python3', stderr=subprocess.PIPE, env=env
        )
        self.messages = {}
        for source in setup:
            assert self.run(source).error is None

    def send(self, source):
        cell = Cell(self, self.client.execute(source))
        self.messages[cell.id] = []
        return cell

    def run(self, source):
        cell = self.send(source)
        self.wait_for(lambda: cell.done)
        return cell

    def wait_for(self, condition, timeout_sec=30):
        """Take messages until the condition holds; return whether it does."""
        deadline = time.monotonic() + timeout_sec
        while not condition() and time.monotonic() < deadline:
            with contextlib.suppress(queue.Empty):
                message = self.client.get_iopub_msg(timeout=0.1)
                parent_id = message['parent_header'].get('msg_id')
                self.messages.setdefault(parent_id, []).append(message)
        return condition()

    def value(self, expression):
        """What `repr` says of an expression."""
        cell = self.run(f'print(repr(({expression})))')
        assert cell.error is None
        return cell.stdout.strip()

    def restart(self):
        """Restart the kernel as JupyterLab does."""
        self.manager.restart_kernel()
        self.client.wait_for_ready(timeout=60)

    def shut_down(self):
        """Shut the kernel down as JupyterLab does; return its exit status and its stderr."""
        process = self.manager.provisioner.process
        self.client.stop_channels()
        self.manager.request_shutdown()
        process.wait(timeout=30)
        stderr = process.stderr.read().decode()
        self.manager.shutdown_kernel(now=True)
        return process.returncode, stderr


class Cell:
    """The outputs of one cell, also those that come after its end."""

    def __init__(self, lesson, message_id):
        self.id = message_id
        self._lesson = lesson

    def _contents(self, *types):
        return [m['content'] for m in self._lesson.messages[self.id] if m['msg_type'] in types]

    @property
    def done(self):
        return any(c['execution_state'] == 'idle' for c in self._contents('status'))

    @property
    def stdout(self):
        return ''.join(c['text'] for c in self._contents('stream') if c['name'] == 'stdout')

    @property
    def stderr(self):
        return ''.join(c['text'] for c in self._contents('stream') if c['name'] == 'stderr')

    @property
    def error(self):
        return next(
            (
                re.sub(r'\x1b\[\d[\d;]*m', '', '\n'.join(c['traceback']))
                for c in self._contents('error')
            ),
            None,
        )

    @property
    def displays(self):
        """The states of what the cell shows, oldest first."""
        return self._contents('display_data', 'update_display_data')

    @property
    def panel(self):
        """What the panel says now."""
        return self.displays[-1]['data']['text/plain'] if self.displays else ''


@pytest.fixture(scope='module')
def lesson():
    lesson = Lesson(TALKER)
    yield lesson
    for cell_id in lesson.messages:
        assert Cell(lesson, cell_id).stderr == ''
    returncode, stderr = lesson.shut_down()
    assert returncode == 0
    assert 'terminate called' not in stderr


@pytest.fixture(autouse=True)
def nothing_runs(request):
    yield
    if 'lesson' in request.fixturenames:
        lesson = request.getfixturevalue('lesson')
        stop = lesson.run('stop()')
        if not stop.done:  # a cell did not end: its test has failed, and no other is to
            lesson.restart()
            stop = lesson.run(TALKER)
        assert stop.error is None


def test_the_same_cell_again_replaces_the_node(lesson):
    for _ in range(20):
        cell = lesson.run('talker = run(Talker)')
        assert cell.error is None
        assert cell.stdout == ''
    assert lesson.value('publishers()') == "['talker']"
    names = lesson.value('talker.get_node_names()')
    assert names.count('talker') == 1
    assert 'UNKNOWN' not in names
    assert lesson.value('alive(talker)') == 'True'


def test_a_class_defined_anew_replaces_the_old_one(lesson):
    lesson.run("old = run(Talker, 'old')")
    lesson.run('class Talker(Talker): pass')
    assert lesson.run("talker = run(Talker, 'new')").error is None
    assert lesson.value('publishers()') == "['talker']"
    assert lesson.value('talker.text, alive(talker)') == "('new', True)"


def test_another_class_with_the_same_node_name_replaces_it_too(lesson):
    lesson.run('run(Talker)')
    lesson.run('class Louder(Talker): pass')
    assert lesson.run('louder = run(Louder)').error is None
    assert lesson.value('publishers()') == "['talker']"
    assert lesson.value('alive(louder)') == 'True'


def test_two_nodes_of_one_class_run_under_two_keys(lesson):
    lesson.run("""class Named(Talker):
    def __init__(self, name):
        Node.__init__(self, name)
        self.count = 0
        self.create_timer(0.05, lambda: setattr(self, 'count', self.count + 1))""")
    lesson.run("left, right = run(Named, 'left', key='l'), run(Named, 'right', key='r')")
    assert lesson.value('alive(left), alive(right)') == '(True, True)'
    lesson.run("stop('l')")
    assert lesson.value("'left' in right.get_node_names(), alive(right)") == '(False, True)'
    lesson.run('stop(right)')
    assert "no node runs as 'r'" in lesson.run("stop('r')").stdout


def test_rclpy_shut_down_by_hand(lesson):
    cell = lesson.run('run(Talker)')
    lesson.run('rclpy.shutdown()')
    assert lesson.wait_for(lambda: cell.panel.startswith('Talker: rclpy was shut down'))
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"
    # shut down behind rclpy's back, as `with rclpy.get_default_context()` would
    lesson.run('rclpy.get_default_context().shutdown()')
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


def test_rclpy_initialised_in_another_domain_is_said(lesson):
    lesson.run('reset()')
    lesson.run('rclpy.init(domain_id=231)')
    cell = lesson.run('talker = run(Talker)')
    domain_id = lesson.value('classroom.enter()')
    assert f'in ROS domain 231, and this lesson is in {domain_id}' in cell.stdout
    lesson.run('rclpy.shutdown()')
    assert lesson.run('talker = run(Talker)').stdout == ''


def test_rclpy_initialised_and_left_by_the_student(lesson):
    lesson.run('reset()')
    lesson.run("rclpy.init(); own = Talker('by hand')")
    # a node that was left on a context shut down is no neighbour: it is buried
    lesson.run('rclpy.shutdown()')
    lesson.run('rclpy.init()')
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


def test_a_node_of_that_name_in_a_thread_and_context_of_its_own(lesson):
    # long acquainted with the domain: nothing waits for the graph any more
    lesson.run('import time; run(Talker); stop(); time.sleep(0.5)')
    cell = lesson.run("""import threading
context = rclpy.Context(); context.init()
class Elsewhere(Node):
    def __init__(self):
        super().__init__('talker', context=context)
elsewhere = Elsewhere()
executor = rclpy.executors.SingleThreadedExecutor(context=context)
executor.add_node(elsewhere)
thread = threading.Thread(target=executor.spin, daemon=True); thread.start()
talker = run(Talker)""")
    assert 'a node named /talker already runs outside live' in cell.stdout
    assert cell.displays == []
    assert lesson.value('talker, publishers()') == '(None, [])'
    lesson.run('executor.shutdown(); thread.join(); elsewhere.destroy_node(); context.shutdown()')
    assert lesson.run('talker = run(Talker)').stdout == ''
    assert lesson.value('alive(talker)') == 'True'


def test_a_node_of_that_name_in_another_process(lesson):
    lesson.run('reset()')
    lesson.run('''import subprocess, sys
other = subprocess.Popen([sys.executable, '-c', """
import rclpy
rclpy.init()
node = rclpy.create_node('talker')
print('made', flush=True)
input()
node.destroy_node()
rclpy.shutdown()
"""], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
other.stdout.readline()''')
    lesson.run('from my_robot_basics.live.runner import _neighbours; _neighbours.meet()')
    try:
        announced = "_neighbours._is_announced('/talker')"
        assert lesson.wait_for(lambda: lesson.value(announced) == 'True')
        assert 'already runs outside live' in lesson.run('talker = run(Talker)').stdout
        assert lesson.value('talker') == 'None'
    finally:
        lesson.run(r"other.communicate(b'\n')")


def test_log_lines_stay_with_the_cell_that_started_the_node(lesson):
    lesson.run("""class Chatty(Talker):
    def tick(self):
        super().tick()
        self.get_logger().warning(f'tick {self.count}')
        print('printed', self.count)""")
    a = lesson.run('chatty = run(Chatty)')
    # what the constructor said is there when the cell ends, always the same
    first = a.displays[0]['data']['text/plain']
    assert first == 'Chatty: running\n[INFO] [talker]: made with x\nin two lines'
    b = lesson.run('assert alive(chatty)')
    assert lesson.wait_for(lambda: '[WARN] [talker]: tick 2' in a.panel)
    assert lesson.wait_for(lambda: 'printed 2' in a.stdout)
    assert (b.stdout, b.displays) == ('', [])
    c = lesson.run("chatty.get_logger().info('<b>bold</b>')")
    assert c.stdout == ''
    assert lesson.wait_for(lambda: '<b>bold' in a.panel)
    assert '&lt;b&gt;bold' in a.displays[-1]['data']['text/html']


def test_what_others_write_to_stdout_goes_to_the_cell_that_runs(lesson):
    lesson.run('run(Talker)')
    cell = lesson.run("""import os, subprocess
os.system('echo from a shell; printf "no newline é"')
subprocess.run(['echo', 'from a program'])
rclpy.logging.get_logger('somebody').info('log line\\nof two')
print('from Python')""")
    # print writes the end of its line by itself: another's line may come in between
    for text in ('from a shell\n', 'no newline é', 'from a program\n', 'from Python'):
        assert lesson.wait_for(lambda text=text: text in cell.stdout), text
    assert lesson.wait_for(lambda: '[somebody]: log line\nof two\n' in cell.stdout)
    assert '\x1f' not in cell.stdout
    assert '\0' not in cell.stdout


def test_an_exception_in_a_callback_is_shown_and_the_node_goes_on(lesson):
    lesson.run("""class Faulty(Talker):
    def tick(self):
        super().tick()
        if self.count % 2:
            mesage = self.message""")
    cell = lesson.run('faulty = run(Faulty, period_sec=0.01)')
    assert lesson.wait_for(lambda: re.search(r'… \d\d+ more times', cell.panel))
    assert lesson.value('alive(faulty)') == 'True'
    assert "AttributeError: 'Faulty' object has no attribute 'message'" in cell.panel
    assert 'line 5, in tick: mesage = self.message' in cell.panel
    assert 'Faulty goes on' in cell.panel
    assert 'rclpy/' not in cell.panel
    assert cell.panel.count('AttributeError') == 1


@pytest.mark.slow
def test_a_flood_is_bounded(lesson):
    lesson.run("""class Flood(Talker):
    def tick(self):
        super().tick()
        for n in range(100):
            self.get_logger().info(f'{n} ' + 1000 * 'x')""")
    start = time.monotonic()
    cell = lesson.run('flood = run(Flood, period_sec=0.01)')
    assert lesson.wait_for(lambda: re.search(r'… \d{4,} earlier lines', cell.panel))
    lesson.run('stop()')
    assert len(cell.displays) <= 4 * (time.monotonic() - start) + 3
    assert all(len(shown['data']['text/plain']) < 6000 for shown in cell.displays)


def test_warnings_of_an_incompatible_qos_are_shown(lesson):
    lesson.run('from rclpy.qos import QoSProfile, ReliabilityPolicy')
    lesson.run('run(Talker)')
    lesson.run("""class Deaf(Node):
    def __init__(self):
        super().__init__('deaf')
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_publisher(String, '/deaf', qos)
        self.create_subscription(String, '/deaf', print, 10)""")
    cell = lesson.run('deaf = run(Deaf)')
    assert lesson.wait_for(lambda: cell.panel.count('incompatible QoS') == 2)


def test_a_constructor_that_raises_leaves_nothing_and_says_why(lesson):
    lesson.run('run(Talker)')
    lesson.run("""class Broken(Talker):
    def __init__(self):
        super().__init__()
        self.wheels = self.no_such_thing""")
    cell = lesson.run("run(Broken, key='Talker')")
    assert "'Broken' object has no attribute 'no_such_thing'" in cell.error
    assert 'runner.py' not in cell.error
    assert cell.panel.startswith('Broken: its constructor failed\n[INFO] [talker]: made with x')
    assert lesson.value('publishers()') == '[]'
    assert lesson.run('talker = run(Talker)').stdout == ''
    lesson.run('class Unmade(Node):\n    def __init__(self): raise ValueError("too early")')
    assert 'too early' in lesson.run('run(Unmade)').error


@pytest.mark.parametrize('thing', ['Talker.tick', 'String', '"Talker"', 'rclpy.create_node("t")'])
def test_what_cannot_run_is_refused_in_two_lines(lesson, thing):
    lesson.run('if not rclpy.ok(): rclpy.init()')
    error = lesson.run(f'run({thing})').error
    assert error.startswith('NotRunnable: run expects ')
    assert len(error.splitlines()) <= 2
    lesson.run('rclpy.try_shutdown()')


def test_an_interrupted_cell_stops_no_node(lesson):
    cell = lesson.run('talker = run(Talker)')
    waiting = lesson.send('print("waiting", flush=True); import time; time.sleep(60)')
    assert lesson.wait_for(lambda: 'waiting' in waiting.stdout)
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: waiting.done)
    assert 'KeyboardInterrupt' in waiting.error
    assert lesson.value('alive(talker)') == 'True'
    assert cell.panel.startswith('Talker: running')


SILENT = """class Silent(Node):
    def __init__(self):
        super().__init__('silent')"""


@pytest.mark.parametrize(
    'endless',
    [
        'rclpy.spin(node)',
        'from rclpy import spin; spin(node)',
        'rclpy.spin_once(node)',
        'executor = rclpy.executors.SingleThreadedExecutor(); executor.add_node(node);'
        'executor.spin()',
        'rclpy.spin_until_future_complete(node, rclpy.task.Future())',
        "from rclpy.wait_for_message import wait_for_message as wait; wait(String, node, '/no')",
    ],
)
def test_a_cell_that_spins_for_ever_can_be_interrupted(lesson, endless):
    lesson.run(f'{SILENT}\nif not rclpy.ok(): rclpy.init()\nnode = Silent()')
    talker = lesson.run('talker = run(Talker)')
    cell = lesson.send(f"print('begun'); {endless}")
    lesson.wait_for(lambda: 'begun' in cell.stdout)
    time.sleep(0.3)  # until it waits
    assert not cell.done
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert cell.error
    assert lesson.value('alive(talker)') == 'True'
    assert talker.panel.startswith('Talker: running')
    lesson.run('node.destroy_node()')


def test_a_cell_that_spins_is_told_how_to_stop_and_how_to_go_on(lesson):
    lesson.run(f'{SILENT}\nif not rclpy.ok(): rclpy.init()')
    cell = lesson.send('node = Silent()\nrclpy.spin(node)')
    assert lesson.wait_for(lambda: '■ (Interrupt the kernel)' in cell.stdout)
    lesson.manager.interrupt_kernel()
    lesson.wait_for(lambda: cell.done)
    assert ' '.join(cell.error.split()) == (
        'rclpy.spin was interrupted, and silent is stopped. To go on, write run(Silent) in place '
        'of the lines that make silent and spin it, and run this cell again: run spins in the '
        'background.'
    )
    # what it says works
    assert lesson.run('node = run(Silent)').stdout == ''
    assert 'already: leave rclpy.spin out' in ' '.join(
        lesson.run('rclpy.spin(node)').error.split()
    )


PROGRAM = f"""{SILENT}
rclpy.init()
node = Silent()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print('caught')
finally:
    node.destroy_node()
    rclpy.shutdown()"""


def test_a_program_pasted_into_a_cell_ends_as_on_a_robot_each_time():
    # in a new kernel: what an earlier rclpy.init has left may keep rclpy's handler away
    lesson = Lesson(TALKER)
    try:
        for _ in range(2):
            ends_when_interrupted(lesson, PROGRAM)
    finally:
        lesson.shut_down()


def ends_when_interrupted(lesson, program):
    cell = lesson.send(program)
    assert lesson.wait_for(lambda: '■' in cell.stdout)
    time.sleep(0.3)  # until it waits
    assert not cell.done
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert (cell.error, cell.stdout.splitlines()[-1]) == (None, 'caught')


def test_a_program_spins_after_one_that_was_interrupted_as_rclpy_made_its_executor(lesson):
    lesson.run('reset()\nfrom unittest.mock import patch')
    # what rclpy calls when it has kept the executor, and before it would drop it at a shutdown
    moment = "with patch('rclpy.get_default_context', side_effect=KeyboardInterrupt):"
    spin = 'rclpy.spin(node)'
    assert 'caught' in lesson.run(PROGRAM.replace(spin, f'{moment} {spin}')).stdout
    ends_when_interrupted(lesson, PROGRAM)


def test_an_interrupt_that_meets_the_deletion_of_an_object_is_not_lost(lesson):
    lesson.run(f"""{SILENT}
class Meeting:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)  # Python drops what is raised here
import signal
if not rclpy.ok(): rclpy.init()""")
    cell = lesson.send('node = Silent(); meeting = Meeting(); del meeting; rclpy.spin(node)')
    assert lesson.wait_for(lambda: cell.done)
    assert 'silent is stopped' in ' '.join(cell.error.split())
    assert cell.stderr == ''


MEETING = """class Meeting:
    def __init__(self, lock): self.lock = lock
    def acquire(self, *args):
        self.lock.acquire(*args)
        raise KeyboardInterrupt  # where Python may raise it
    def __getattr__(self, name): return getattr(self.lock, name)

def interrupt(ask, thread):
    lock, thread._tstate_lock = thread._tstate_lock, Meeting(thread._tstate_lock)
    try: ask()
    except KeyboardInterrupt: pass
    if thread._tstate_lock is not None: thread._tstate_lock = lock"""


@pytest.mark.skipif(sys.version_info >= (3, 13), reason='a thread has no such lock')
def test_an_interrupt_takes_no_thread_for_dead(lesson):
    """As ipykernel's that sends a kernel's outputs: two would send them at the same time then."""
    lesson.run(f"""{MEETING}
import threading
end = threading.Event()
runs = threading.Thread(target=end.wait); runs.start()
interrupt(runs.is_alive, runs)""")
    assert lesson.value('runs.is_alive()') == 'True'
    # where it has ended, as whoever asked was interrupted, that is not forgotten
    lesson.run('end.set(); interrupt(runs.join, runs); runs.join()')
    assert lesson.value('runs.is_alive()') == 'False'


def test_a_second_init_is_explained_in_a_sentence(lesson):
    lesson.run('run(Talker)')
    error = ' '.join(lesson.run('rclpy.init()').error.split())
    assert re.fullmatch(
        r'AlreadyInitialised: rclpy is initialised already, .+: leave rclpy.init\(\) out here, '
        'and run this cell again',
        error,
    )
    assert lesson.run('try: rclpy.init()\nexcept RuntimeError: pass').error is None
    assert lesson.run('c = rclpy.Context(); rclpy.init(context=c); c.shutdown()').error is None


def test_where_work_is_graded_rclpy_is_as_it_is_on_a_robot():
    room = "import os; os.environ['MY_ROBOT_BASICS_ROOM'] = 'student'"
    lesson = Lesson(room, 'import rclpy; spin, init = rclpy.spin, rclpy.init', TALKER)
    try:
        assert lesson.value('(rclpy.spin, rclpy.init) == (spin, init)') == 'True'
        # only an interrupt is better off: it need not kill the kernel where a cell's time is over
        lesson.run(f'{SILENT}\nrun(Talker)')
        cell = lesson.send("node = Silent(); print('begun'); rclpy.spin(node)")
        lesson.wait_for(lambda: 'begun' in cell.stdout)
        time.sleep(0.3)  # until it waits
        assert not cell.done
        lesson.manager.interrupt_kernel()
        assert lesson.wait_for(lambda: cell.done)
        assert 'KeyboardInterrupt' in cell.error
    finally:
        lesson.shut_down()


def test_a_node_that_was_stopped_and_said_nothing_leaves_nothing_to_read(lesson):
    lesson.run(SILENT)
    cell = lesson.run('run(Silent)')
    assert cell.panel == 'Silent: running'
    lesson.run('run(Silent)')
    assert lesson.wait_for(lambda: cell.panel == '')
    assert cell.displays[-1]['data']['text/html'] == ''
    talker = lesson.run('run(Talker)')
    lesson.run('stop()')
    assert lesson.wait_for(lambda: talker.panel.startswith('Talker: stopped\n[INFO]'))


def test_a_constructor_that_blocks_can_be_interrupted(lesson):
    lesson.run('run(Talker)')
    lesson.run("""class Blocking(Talker):
    def __init__(self):
        super().__init__()
        print('blocks', flush=True)
        __import__('time').sleep(60)""")
    cell = lesson.send("run(Blocking, key='Talker')")
    assert lesson.wait_for(lambda: 'blocks' in cell.stdout)
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert 'KeyboardInterrupt' in cell.error
    assert lesson.value('publishers()') == '[]'
    lesson.run('talker = run(Talker)')
    assert lesson.value('alive(talker)') == 'True'


def test_a_node_that_spins_itself_is_left_to_it_and_stopped_all_the_same(lesson):
    lesson.run("""import threading
class Selfish(Talker):
    def __init__(self):
        super().__init__()
        self.own = rclpy.executors.SingleThreadedExecutor()
        self.own.add_node(self)
        threading.Thread(target=self.own.spin, daemon=True).start()""")
    for _ in range(3):
        assert lesson.run('selfish = run(Selfish)').error is None
    assert lesson.value('publishers(), alive(selfish)') == "(['talker'], True)"
    lesson.run('stop()')
    assert lesson.value('publishers()') == '[]'


@pytest.mark.parametrize('body', ['time.sleep(0.02)', 'self.publisher.publish(String())'])
def test_a_callback_that_does_not_return_can_be_replaced(lesson, body):
    lesson.run(f"""import time
class Stuck(Talker):
    def tick(self):
        while True:
            self.count += 1
            {body}
            self.publisher.publish(String(data='stuck'))""")
    lesson.run('stuck = run(Stuck)')
    assert lesson.value('alive(stuck)') == 'True'
    assert lesson.run('talker = run(Talker)').stdout == ''
    assert lesson.value('publishers(), alive(talker), frozen(stuck)') == "(['talker'], True, True)"


def test_a_callback_that_stops_its_own_node(lesson):
    lesson.run("""class Quitter(Talker):
    def tick(self):
        stop(self)""")
    lesson.run('quitter = run(Quitter)')
    assert lesson.wait_for(lambda: lesson.value('publishers()') == '[]')
    lesson.run("""class Leaver(Talker):
    def tick(self):
        raise SystemExit""")
    cell = lesson.run('leaver = run(Leaver)')
    assert lesson.wait_for(lambda: 'a callback called exit()' in cell.panel)
    assert lesson.wait_for(lambda: lesson.value('publishers()') == '[]')


def test_reset_and_run_answer(lesson):
    lesson.run('run(Talker)')
    lesson.run('class Answer(Talker): pass')
    assert 'reset' in lesson.run("reset('Answer', 'never_defined')").stdout
    assert lesson.value("'Answer' in globals(), rclpy.ok()") == '(False, False)'
    error = lesson.run("run_answer('Answer')").error
    assert 'saw nothing of that name: run the answer cell' in ' '.join(error.split())
    assert len(error.splitlines()) <= 2
    where = 'write it in the answer cell: only the notebook is submitted'
    for definition, advice in {
        'Answer = 3': 'saw an object of type int: begin it with `class Answer(Node):`',
        'class Answer: pass': 'saw one that is not: begin it with `class Answer(Node):`',
        'from my_robot_basics.kinematics_publisher import KinematicsPublisher as Answer': where,
    }.items():
        lesson.run(definition)
        error = lesson.run("run_answer('Answer')").error
        assert error.startswith('NotRunnable: expected ')
        assert ' '.join(error.split()).endswith(advice)
        assert len(error.splitlines()) <= 2
    lesson.run("class Answer(Talker): pass\nanswer = run_answer('Answer', 'yes')")
    assert lesson.value('answer.text, alive(answer)') == "('yes', True)"
    lesson.run('reset()')
    assert lesson.run('rclpy.init(); rclpy.shutdown()').error is None


def test_an_answer_that_makes_its_node_and_does_not_spin_it_is_told_so(lesson):
    lesson.run("reset('Answer')")
    lesson.run('class Answer(Talker): pass\nrclpy.init()\nmine = Answer()')
    error = lesson.run("run_answer('Answer')").error
    assert 'saw a node of it that nothing spins: leave out the' in ' '.join(error.split())
    assert len(error.splitlines()) <= 2
    lesson.run('mine.destroy_node()')
    assert lesson.run("answer = run_answer('Answer')").error is None
    lesson.run('reset()')


IMPORTED = 'from my_robot_basics import kinematics_publisher as course\n'
TAKEN = {
    'derives': f'{IMPORTED}class Answer(course.KinematicsPublisher): pass',
    'derives by a class between': f"""{IMPORTED}
class Between(course.KinematicsPublisher): pass
class Answer(Between): pass""",
    'takes a method': f"""{IMPORTED}
class Answer(Node):
    publish_pose = course.KinematicsPublisher.publish_pose
    def __init__(self): super().__init__('answer')""",
    'makes one': f"""{IMPORTED}
class Answer(Node):
    def __init__(self):
        super().__init__('answer')
        self.inner = course.KinematicsPublisher()""",
}


@pytest.mark.parametrize('definition', TAKEN.values(), ids=TAKEN)
def test_no_answer_is_made_of_the_courses_nodes(lesson, definition):
    lesson.run("reset('Answer')")
    assert lesson.run(definition).error is None
    error = ' '.join(lesson.run("run_answer('Answer')").error.split())
    assert error.startswith('NotRunnable: expected ')
    assert 'write your own in the answer cell' in error
    assert lesson.run('run(course.KinematicsPublisher); stop()').error is None


def test_an_answer_may_call_the_courses_functions(lesson):
    lesson.run("reset('Answer')")
    lesson.run("""from my_robot_basics.two_link_kinematics import forward_kinematics
class Answer(Node):
    forward = staticmethod(forward_kinematics)
    def __init__(self):
        super().__init__('answer')
        self.point = self.forward(0.0, 0.0)""")
    assert lesson.run("answer = run_answer('Answer')").error is None
    assert lesson.value('answer.point[0] > 1.7') == 'True'


@pytest.mark.slow
def test_the_arm_follows_the_joint_states(lesson):
    lesson.run("""from sensor_msgs.msg import JointState
class Mover(Talker):
    def __init__(self):
        Node.__init__(self, 'mover')
        self.publisher = self.create_publisher(JointState, '/joints', 10)
        self.count = 0
        self.create_timer(0.05, self.tick)
    def tick(self):
        self.count += 1
        position = [0.1 * self.count, 1.0] if self.count % 5 else []
        self.publisher.publish(JointState(name=['joint1', 'joint2'], position=position))""")
    lesson.run('run(Mover)')
    cell = lesson.run("follow_arm('/joints')")
    assert cell.error is None
    assert lesson.wait_for(lambda: len({d['data']['image/png'] for d in cell.displays}) >= 4)
    assert {d['data']['text/plain'] for d in cell.displays} == {
        'two-link arm that follows /joints'
    }
    assert cell.displays[0]['metadata']['image/png']['alt']

    assert len({d['transient']['display_id'] for d in cell.displays}) == 1
    lesson.run('stop()')
    last = lesson.run('show_arm(30, 45)')
    assert 'θ1 = 30.0°' in last.panel
    assert lesson.value('[n for n in publishers("/joints")]') == '[]'


def test_a_picture_comes_with_its_words_where_a_plain_png_would_lose_them(lesson):
    [shown] = lesson.run('from my_robot_basics.live import show_arm; show_arm(30, 45)').displays
    png, text = shown['data']['image/png'].replace('\n', ''), shown['data']['text/plain']
    assert 'θ1 = 30.0°' in text
    assert shown['data']['text/html'] == f'<img alt="{text}" src="data:image/png;base64,{png}">'


@pytest.mark.slow
def test_two_kernels_have_two_domains_and_give_them_back(lesson):
    mine = int(lesson.value('classroom.enter()'))
    other = Lesson(TALKER)
    theirs = int(other.value('classroom.enter()'))
    assert mine != theirs
    other.run('talker = run(Talker)')
    with Witness(theirs) as witness:
        assert witness.sees('talker', present=True)
        returncode, stderr = other.shut_down()
        assert returncode == 0
        assert 'terminate called' not in stderr
        # nobody had to wait for the lease of a dead participant to run out
        assert witness.sees('talker', present=False, timeout_sec=4)
        assert '/talk' not in dict(witness.node.get_topic_names_and_types())


def claim_of(domain_id):
    """The socket that holds a domain; another kernel of this machine may take it next."""
    name = f'@my_robot_basics.domain.{domain_id}'
    rows = [line.split() for line in Path('/proc/net/unix').read_text().splitlines()]
    return [row[6] for row in rows if row[-1] == name]


def test_a_killed_kernel_gives_its_domain_back_though_its_child_lives():
    lesson = Lesson(TALKER)
    domain_id = lesson.value('classroom.enter()')
    start = "__import__('subprocess').Popen(['sleep', '60'], start_new_session=True).pid"
    child = int(lesson.value(start))
    claim = claim_of(domain_id)
    assert claim
    try:
        os.kill(lesson.manager.provisioner.pid, signal.SIGKILL)
        lesson.manager.provisioner.process.wait()
        os.kill(child, 0)
        assert claim_of(domain_id) != claim
    finally:
        os.kill(child, signal.SIGKILL)
        lesson.client.stop_channels()
        lesson.manager.shutdown_kernel(now=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    'unruly',
    [
        'class Unruly(Talker):\n    def tick(self): __import__("time").sleep(60)\nrun(Unruly)',
        'class Unruly(Talker):\n    def tick(self):\n        while True: pass\nrun(Unruly)',
        'rclpy.init(); own = Talker()\n'
        '__import__("threading").Thread(target=rclpy.spin, args=(own,), daemon=True).start()',
        'rclpy.init(); own = Talker(); run(Talker)',
    ],
    ids=['sleeps', 'never_returns', 'own_thread', 'never_spun'],
)
def test_unruly_nodes_do_not_abort_the_kernel_when_it_ends(unruly):
    lesson = Lesson(TALKER, unruly)
    returncode, stderr = lesson.shut_down()
    assert returncode == 0
    assert 'terminate called' not in stderr


@pytest.mark.slow
def test_a_restarted_kernel_runs_the_lesson_again(lesson):
    lesson.run('run(Talker)')
    lesson.restart()
    assert lesson.run(TALKER).error is None
    assert lesson.run('talker = run(Talker)').stdout == ''
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


class Witness:
    """A node of another process than the kernel's, in the kernel's domain."""

    def __init__(self, domain_id):
        self.context = rclpy.Context()
        self.context.init(domain_id=domain_id)
        self.node = Node('_witness', context=self.context)

    def __enter__(self):
        return self

    def __exit__(self, *exc_info):
        self.node.destroy_node()
        self.context.shutdown()

    def sees(self, name, *, present, timeout_sec=10):
        deadline = time.monotonic() + timeout_sec
        while (name in self.node.get_node_names()) is not present:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.02)
        return True


@pytest.mark.slow
def test_in_a_script_the_node_runs_and_nothing_is_left(tmp_path):
    script = tmp_path / 'script.py'
    script.write_text(
        TALKER + "faulty = type('Faulty', (Talker,), {'tick': lambda self: 1 / 0})\n"
        'talker = run(Talker)\nassert alive(talker)\nrun(faulty)\n'
        'import time; time.sleep(0.3)\nprint(publishers())\n'
    )
    result = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, '')
    assert '[talker]: made with x' in result.stdout
    assert 'ZeroDivisionError: division by zero' in result.stdout
    assert "['talker']" in result.stdout
