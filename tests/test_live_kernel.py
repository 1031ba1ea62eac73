"""What `live` promises, in real notebook kernels."""

import re
import time

import pytest
from live_lesson import SILENT, opened_lesson, stop_nodes_after


@pytest.fixture(scope='module')
def lesson():
    yield from opened_lesson()


@pytest.fixture(autouse=True)
def nothing_runs(request):
    yield from stop_nodes_after(request)


def test_running_a_cell_again_replaces_its_node(lesson):
    for _ in range(20):
        cell = lesson.run('talker = run(Talker)')
        assert cell.error is None
        assert cell.stdout == ''
    assert lesson.value('publishers()') == "['talker']"
    names = lesson.value('talker.get_node_names()')
    assert names.count('talker') == 1
    assert 'UNKNOWN' not in names
    assert lesson.value('alive(talker)') == 'True'


def test_a_node_of_a_redefined_class_replaces_the_old_node(lesson):
    lesson.run("old = run(Talker, 'old')")
    lesson.run('class Talker(Talker): pass')
    assert lesson.run("talker = run(Talker, 'new')").error is None
    assert lesson.value('publishers()') == "['talker']"
    assert lesson.value('talker.text, alive(talker)') == "('new', True)"


def test_a_node_of_another_class_with_the_same_name_replaces_the_old_node(lesson):
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
    lesson.run("left = run(Named, 'left', key='l'); stop('/left')")
    assert lesson.value("'left' in right.get_node_names(), alive(right)") == '(False, True)'
    lesson.run('stop(right)')
    assert "no node runs as 'r'" in lesson.run("stop('r')").stdout


def test_run_works_again_after_rclpy_was_shut_down_by_hand(lesson):
    cell = lesson.run('run(Talker)')
    lesson.run('rclpy.shutdown()')
    assert lesson.wait_for(lambda: cell.panel.startswith('Talker: rclpy was shut down'))
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"
    # shut down behind rclpy's back, as `with rclpy.get_default_context()` would
    lesson.run('rclpy.get_default_context().shutdown()')
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


def test_run_warns_if_rclpy_is_initialised_in_another_domain(lesson):
    lesson.run('reset()')
    lesson.run('rclpy.init(domain_id=231)')
    cell = lesson.run('talker = run(Talker)')
    domain_id = lesson.value('classroom.enter()')
    assert f'in ROS domain 231, and this lesson is in {domain_id}' in cell.stdout
    lesson.run('rclpy.shutdown()')
    assert lesson.run('talker = run(Talker)').stdout == ''


def test_run_ignores_a_node_left_on_a_context_that_was_shut_down(lesson):
    lesson.run('reset()')
    lesson.run("rclpy.init(); own = Talker('by hand')")
    # a node left on a context that was shut down is not a neighbour: it is destroyed
    lesson.run('rclpy.shutdown()')
    lesson.run('rclpy.init()')
    assert lesson.run('talker = run(Talker)').error is None
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


def test_run_starts_no_node_whose_name_runs_in_another_context(lesson):
    # the domain has been in use for a while: nothing waits for the graph any more
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


def test_run_starts_no_node_whose_name_runs_in_another_process(lesson):
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
    lesson.run('from my_robot_basics.live.nodes.runner import _neighbours; _neighbours.start()')
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
    # what the constructor logged is there when the cell ends, always the same
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


def test_other_output_to_stdout_goes_to_the_cell_that_runs(lesson):
    lesson.run('run(Talker)')
    cell = lesson.run("""import os, subprocess
os.system('echo from a shell; printf "no newline é"')
subprocess.run(['echo', 'from a program'])
rclpy.logging.get_logger('somebody').info('log line\\nof two')
print('from Python')""")
    # print writes the end of its line separately: a line of another writer may come in between
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
def test_a_flood_of_log_lines_is_bounded(lesson):
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


def test_a_constructor_that_raises_leaves_no_node_and_shows_its_error(lesson):
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
def test_an_object_that_is_not_a_node_class_is_refused_in_two_lines(lesson, thing):
    lesson.run('if not rclpy.ok(): rclpy.init()')
    error = lesson.run(f'run({thing})').error
    assert error.startswith('NotRunnable: run expects ')
    assert len(error.splitlines()) <= 2
    lesson.run('rclpy.try_shutdown()')


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


def test_the_panel_of_a_stopped_node_that_logged_nothing_is_empty(lesson):
    lesson.run(SILENT)
    cell = lesson.run('run(Silent)')
    assert cell.panel == 'Silent: running'
    lesson.run('run(Silent)')
    assert lesson.wait_for(lambda: cell.panel == '')
    assert cell.displays[-1]['data']['text/html'] == ''
    talker = lesson.run('run(Talker)')
    lesson.run('stop()')
    assert lesson.wait_for(lambda: talker.panel.startswith('Talker: stopped\n[INFO]'))


def test_a_node_that_spins_itself_runs_and_can_be_stopped(lesson):
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
def test_a_node_whose_callback_does_not_return_can_be_replaced(lesson, body):
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


def test_a_callback_can_stop_its_own_node(lesson):
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


def test_a_picture_is_shown_as_html_with_its_description_as_alt_text(lesson):
    [shown] = lesson.run('from my_robot_basics.live import show_arm; show_arm(30, 45)').displays
    png, text = shown['data']['image/png'].replace('\n', ''), shown['data']['text/plain']
    assert 'θ1 = 30.0°' in text
    assert shown['data']['text/html'] == f'<img alt="{text}" src="data:image/png;base64,{png}">'
