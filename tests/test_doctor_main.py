"""Two ways to ask the doctor: the console script and its exit status, `live.why` in a notebook."""

import subprocess
import sys

import pytest
from jupyter_client.manager import start_new_kernel
from my_robot_basics.doctor.main import main
from my_robot_basics.live import run, stop, why
from my_robot_basics.live.pictures.doctor import NoSuchName
from nodes import patient_services
from nodes.patient import LISTENER, TALKER, TOPIC, node_class


@pytest.fixture
def _talker():
    run(node_class(TALKER))
    yield
    stop()


@pytest.mark.slow
@pytest.mark.starts
@pytest.mark.usefixtures('_talker')
def test_the_doctor_exits_with_1_for_a_fault_and_with_0_if_all_is_well(capfd):
    assert main([TOPIC]) == 1
    out, err = capfd.readouterr()
    assert out.startswith(f'Something is wrong on {TOPIC}: /talker publishes, nobody subscribes')
    assert '1. no subscription' in out
    run(node_class(LISTENER))
    assert main([TOPIC.removeprefix('/')]) == 0
    well, more = capfd.readouterr()
    assert well.startswith(f'All is well on {TOPIC}: /talker publishes, /listener subscribes, ')
    assert err == more == ''


@pytest.mark.slow
@pytest.mark.starts
def test_a_service_is_diagnosed_by_its_name(capfd):
    run(patient_services.node_class(patient_services.SERVER))
    assert main([patient_services.NAME.removeprefix('/')]) == 0
    assert (
        capfd.readouterr().out == 'All is well on /close_gripper: /server serves, nobody asks.\n'
    )
    assert main(['/close_griper']) == 1
    stop()
    assert '$ topic_doctor /close_gripper\n' in capfd.readouterr().out


@pytest.mark.parametrize(
    ('words', 'complaint'),
    [
        ([], 'the following arguments are required: name'),
        (['/a b'], "'/a b' is not the name of a topic or a service"),
        ([''], "'' is not the name of a topic or a service"),
        (['/a//b'], "'/a//b' is not the name of a topic or a service"),
        ([TOPIC, '--seconds', 'x'], "invalid time in seconds value: 'x'"),
        ([TOPIC, '--seconds', '-1'], "invalid time in seconds value: '-1'"),
        ([TOPIC, '--seconds', 'nan'], "invalid time in seconds value: 'nan'"),
    ],
)
def test_wrong_arguments_are_reported_with_exit_code_2(capsys, words, complaint):
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == 2
    assert complaint in capsys.readouterr().err


def test_an_invalid_domain_id_is_reported_with_exit_code_2(monkeypatch, capsys):
    monkeypatch.setenv('ROS_DOMAIN_ID', 'mine')
    with pytest.raises(SystemExit) as stopped:
        main([TOPIC])
    assert stopped.value.code == 2
    assert "ROS_DOMAIN_ID is 'mine'" in capsys.readouterr().err


@pytest.mark.starts
def test_help_needs_no_ros():
    program = (
        'import sys; from my_robot_basics.doctor.main import main\n'
        'try: main(["--help"])\n'
        'finally: print("rclpy" in sys.modules)'
    )
    done = subprocess.run(
        [sys.executable, '-c', program], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == 'False'


def test_a_notebook_that_asks_about_an_impossible_name_gets_an_error():
    with pytest.raises(NoSuchName, match='is not the name of a topic or a service'):
        why('/joint states')
    with pytest.raises(NoSuchName, match='is not a text: expected the name of a topic'):
        why(why)


@pytest.fixture
def cell():
    """Run a cell in a notebook's kernel, and return its outputs."""
    manager, client = start_new_kernel()

    def run_cell(code):
        outputs = []
        client.execute_interactive(
            code, timeout=60, output_hook=lambda message: outputs.append(message)
        )
        return [m['content'] for m in outputs if m['msg_type'] in WANTED]

    yield run_cell
    client.stop_channels()
    manager.shutdown_kernel()


WANTED = ('stream', 'display_data', 'error')


@pytest.mark.slow
@pytest.mark.starts
def test_a_notebook_shows_the_diagnosis_and_a_picture_each_time(cell):
    ask = f"from my_robot_basics import live\nlive.why('{TOPIC}')"
    for _ in range(2):
        said, shown = cell(ask)
        assert '1. no publisher' in said['data']['text/plain']
        assert '<li><b>no publisher</b>' in said['data']['text/html']
        assert shown['data']['image/png']
        assert shown['metadata']['image/png']['alt'] == shown['data']['text/plain']
        assert 'broken: no publisher' in shown['data']['text/plain']
    (error,) = cell("live.why('a b')")
    assert ' '.join(error['traceback']).startswith(
        "NoSuchName: 'a b' is not the name of a topic or a service ("
    )
