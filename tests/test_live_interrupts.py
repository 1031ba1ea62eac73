"""A cell that spins, waits or runs a program, and the ■ that interrupts it, in real kernels."""

import sys
import time
from pathlib import Path

import nbformat
import psutil
import pytest
from live_lesson import SILENT, TALKER, Lesson, opened_lesson, stop_nodes_after


@pytest.fixture(scope='module')
def lesson():
    yield from opened_lesson()


@pytest.fixture(autouse=True)
def nothing_runs(request):
    yield from stop_nodes_after(request)


def test_an_interrupted_cell_stops_no_node(lesson):
    cell = lesson.run('talker = run(Talker)')
    waiting = lesson.send('print("waiting", flush=True); import time; time.sleep(60)')
    assert lesson.wait_for(lambda: 'waiting' in waiting.stdout)
    time.sleep(0.3)  # until it waits: IPython may lose an interrupt between two statements
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: waiting.done)
    assert 'KeyboardInterrupt' in waiting.error
    assert lesson.value('alive(talker)') == 'True'
    assert cell.panel.startswith('Talker: running')


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


def test_a_cell_that_spins_says_how_to_stop_and_how_to_go_on(lesson):
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
    # the advice of the message works
    assert lesson.run('node = run(Silent)').stdout == ''
    assert 'already: leave rclpy.spin out' in ' '.join(
        lesson.run('rclpy.spin(node)').error.split()
    )


def test_a_constructor_that_spins_says_how_to_go_on(lesson):
    lesson.run(
        f'{SILENT}\nclass Spinning(Silent):\n    def __init__(self):\n'
        '        super().__init__()\n        rclpy.spin(self)'
    )
    cell = lesson.send('run(Spinning)')
    assert lesson.wait_for(lambda: '■ (Interrupt the kernel)' in cell.stdout)
    lesson.manager.interrupt_kernel()
    lesson.wait_for(lambda: cell.done)
    assert ' '.join(cell.error.split()) == (
        'rclpy.spin was interrupted, and silent is stopped. To go on, leave rclpy.spin out of '
        '__init__, and run the cells again: run spins a node in the background when its '
        'constructor has returned.'
    )
    assert lesson.run('node = run(Silent)').error is None


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


def test_a_pasted_program_catches_each_interrupt_as_it_does_on_a_robot():
    # in a new kernel: an earlier rclpy.init may keep rclpy from installing its signal handler
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


def test_a_program_spins_after_an_interrupt_while_rclpy_made_an_executor(lesson):
    lesson.run('reset()\nfrom unittest.mock import patch')
    # rclpy calls this after it has kept the executor, and before it could drop it at a shutdown
    moment = "with patch('rclpy.get_default_context', side_effect=KeyboardInterrupt):"
    spin = 'rclpy.spin(node)'
    assert 'caught' in lesson.run(PROGRAM.replace(spin, f'{moment} {spin}')).stdout
    ends_when_interrupted(lesson, PROGRAM)


def test_an_interrupt_during_the_deletion_of_an_object_is_not_lost(lesson):
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


def test_an_interrupt_during_a_flush_leaves_no_lock_that_the_output_thread_needs(lesson):
    cell = lesson.run("""import signal, threading
from unittest.mock import patch
acquire = threading.Condition.__enter__
def acquire_and_interrupt(condition):  # where Python may raise it
    acquire(condition)
    if threading.current_thread() is threading.main_thread():
        signal.raise_signal(signal.SIGINT)
with patch('threading.Condition.__enter__', acquire_and_interrupt):
    print('flushed', flush=True)""")
    assert cell.done
    assert cell.stdout == 'flushed\n'
    assert lesson.value('1 + 1') == '2'


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
def test_a_running_thread_still_counts_as_alive_after_an_interrupt(lesson):
    """Such as ipykernel's thread that sends outputs: if it seemed dead, two threads would send."""
    lesson.run(f"""{MEETING}
import threading
end = threading.Event()
runs = threading.Thread(target=end.wait); runs.start()
interrupt(runs.is_alive, runs)""")
    assert lesson.value('runs.is_alive()') == 'True'
    # a thread that ended during an interrupted join is known to have ended
    lesson.run('end.set(); interrupt(runs.join, runs); runs.join()')
    assert lesson.value('runs.is_alive()') == 'False'


def test_rclpy_is_unchanged_in_a_grading_room():
    room = "import os; os.environ['MY_ROBOT_BASICS_ROOM'] = 'student'"
    lesson = Lesson(room, 'import rclpy; spin, init = rclpy.spin, rclpy.init', TALKER)
    try:
        assert lesson.value('(rclpy.spin, rclpy.init) == (spin, init)') == 'True'
        # only interrupts differ: at the end of a cell's time, one need not kill the kernel
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


WAITING = """class Waiting(Talker):
    def __init__(self):
        super().__init__()
        print('waits', flush=True)
        self.create_client(SetBool, '/nobody').wait_for_service({})"""


def test_a_constructor_that_does_not_return_is_named_with_its_line(lesson):
    lesson.run(f'from std_srvs.srv import SetBool\n{WAITING.format("")}')
    cell = lesson.send('run(Waiting)')
    assert lesson.wait_for(lambda: len(cell.displays) == 2)  # the first one is empty
    said = ' '.join(cell.panel.split())
    assert said.startswith('the constructor of Waiting has not returned for 5 s. Until it does, ')
    assert 'press ■' in said
    assert said.endswith(
        "loops. line 6, in __init__: self.create_client(SetBool, '/nobody').wait_for_service()"
    )
    assert not cell.done
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert 'KeyboardInterrupt' in cell.error


def test_a_constructor_that_returns_late_leaves_no_text_about_it(lesson):
    lesson.run(f'from std_srvs.srv import SetBool\n{WAITING.format("timeout_sec=6.0")}')
    cell = lesson.send('talker = run(Waiting)')
    assert lesson.wait_for(lambda: cell.done)
    texts = [display['data'].get('text/plain', '') for display in cell.displays]
    assert [text.partition('\n')[0][:20] for text in texts[:4]] == [
        '',
        'the constructor of W',
        '',
        'Waiting: running',
    ]
    assert lesson.value('alive(talker)') == 'True'


TWO_PROGRAMS = """ros2() {
    if [ "$1" = run ]; then trap '' INT; touch "$ROS_WS/$BASHPID"; exec sleep 600; fi
    sleep 0.2  # no node is found, so the cell waits
}"""


@pytest.fixture
def start_both(lesson, tmp_path):
    """A function that sends the cell `processes` of lesson 12, for which `ros2` is a function."""

    def send(ros2):
        (tmp_path / 'install').mkdir()
        (tmp_path / 'install/setup.bash').write_text(ros2)
        text = Path(__file__, '../../solutions/12_package/12_package.ipynb').resolve().read_text()
        [source] = [c.source for c in nbformat.reads(text, 4).cells if c.id == 'processes']
        lesson.run(f"import os; os.environ['ROS_WS'] = '{tmp_path}'")
        return lesson.send(source)

    return send


def has_ended(program):
    """Whether a process is gone, or only waits for its parent to look at its exit status."""
    try:
        return program.status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def test_the_two_programs_of_lesson_12_end_when_their_cell_is_interrupted(
    lesson, start_both, tmp_path
):
    cell = start_both(TWO_PROGRAMS)
    assert lesson.wait_for(lambda: len([*tmp_path.glob('[0-9]*')]) == 2)
    programs = [psutil.Process(int(path.name)) for path in tmp_path.glob('[0-9]*')]
    time.sleep(0.5)  # until it waits
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert lesson.wait_for(lambda: all(map(has_ended, programs)), timeout_sec=5)


def test_the_cell_of_the_two_programs_does_not_wait_forever_for_one_that_has_died(
    lesson, start_both
):
    cell = start_both('ros2() { [ "$1" != run ]; }')
    assert lesson.wait_for(lambda: cell.done)
    assert 'after kill %1' in cell.stdout


@pytest.fixture
def count_participants(lesson):
    """A function that counts the participants of the lesson's kernel."""
    lesson.run('from my_robot_basics.graph import participants')
    return lambda: lesson.value('len(participants.own_ports(classroom.enter()))')


def test_the_participant_of_a_check_ends_with_its_cell(lesson, count_participants):
    lesson.run('talker = run(Talker)')
    before = count_participants()
    lesson.run('from my_robot_basics.checks import fail, topic')
    inside = 'print(len(participants.own_ports(classroom.enter())))'
    for ending in '', "; fail(expected='x', seen='y', hint='z')":
        cell = lesson.run(f"topic('/talk').wait_for(); {inside}{ending}")
        assert int(cell.stdout.split()[0]) == int(before) + 1
        assert cell.error == ('expected x, saw y: z' if ending else None)
        assert count_participants() == before


def test_the_participant_of_an_interrupted_check_ends_with_its_cell(lesson, count_participants):
    lesson.run('talker = run(Talker)')
    before = count_participants()
    cell = lesson.send(
        'from my_robot_basics.checks import topic\n'
        "topic('/talk').wait_for()\n"
        'print(len(participants.own_ports(classroom.enter())))\n'
        "topic('/talk').wait_for(lambda _: False, timeout_sec=60)"
    )
    assert lesson.wait_for(lambda: '\n' in cell.stdout)
    assert int(cell.stdout) == int(before) + 1
    lesson.manager.interrupt_kernel()
    assert lesson.wait_for(lambda: cell.done)
    assert 'KeyboardInterrupt' in cell.error
    assert count_participants() == before
