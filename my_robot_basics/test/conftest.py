import pytest
from hypothesis import HealthCheck, settings
from my_robot_basics.session import domain

# a busy machine fails no test
settings.register_profile('busy', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('busy')


@pytest.fixture(autouse=True)
def own_domain(monkeypatch):
    """A ROS domain that no other test, lesson or robot is in."""
    claim = domain.claim()
    monkeypatch.setenv('ROS_DOMAIN_ID', str(claim.domain_id))
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    for name in ('PYTHONPATH', 'AMENT_PREFIX_PATH', 'COLCON_PREFIX_PATH'):
        monkeypatch.delenv(name, raising=False)
    yield
    claim.release()
