import os


def test_a_kernel_started_by_a_test_does_not_know_of_pytest():
    assert 'PYTEST_CURRENT_TEST' not in os.environ


def test_a_test_session_has_a_domain_of_its_own():
    assert 1 <= int(os.environ['ROS_DOMAIN_ID']) <= 101
