import sys

import pytest

from grader.__main__ import main
from grader.common.errors import ClusterError
from grader.workers.dask_client import Certificates, check_address, connect


@pytest.mark.parametrize(
    'address',
    [
        'tcp://127.0.0.1:8786',
        'tcp://127.8.8.8:8786',
        'tcp://[::1]:8786',
        'tcp://localhost:8786',
        'tls://10.0.0.1:8786',
        'tls://scheduler.example.org:8786',
    ],
)
def test_a_local_or_encrypted_address_is_accepted(address):
    check_address(address)


@pytest.mark.parametrize(
    'address',
    [
        'tcp://10.0.0.1:8786',
        'tcp://0.0.0.0:8786',
        'tcp://scheduler:8786',
        'tcp://localhost.example.org:8786',
        'tcp://[fe80::1]:8786',
    ],
)
def test_an_unencrypted_address_of_another_machine_is_refused_with_the_tls_options(address):
    with pytest.raises(ClusterError, match='--tls-ca-file, --tls-cert and --tls-key'):
        check_address(address)


@pytest.mark.parametrize(
    'address', ['8786', 'localhost:8786', 'ws://127.0.0.1:8786', 'tcp://', 'inproc://x', '']
)
def test_an_invalid_address_is_reported(address):
    with pytest.raises(ClusterError, match='expected tls://HOST:8786'):
        check_address(address)


def test_tls_needs_certificates(tmp_path):
    with pytest.raises(ClusterError, match='needs certificates'):
        connect('tls://127.0.0.1:1', Certificates(ca_file='ca.pem', cert='cert.pem'))


def test_a_missing_scheduler_is_reported(monkeypatch):
    monkeypatch.setattr('grader.workers.dask_client.CONNECT_TIMEOUT_SEC', 0.1)
    with pytest.raises(ClusterError, match=r'no scheduler at tcp://127.0.0.1:1 that answers'):
        connect('tcp://127.0.0.1:1', Certificates())


def test_a_missing_dask_is_reported_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, 'distributed', None)
    with pytest.raises(ClusterError, match=r'pip install -r environment\.txt'):
        connect('tcp://127.0.0.1:1', Certificates())


@pytest.mark.parametrize(
    ('options', 'said'),
    [
        (['--dask', 'tcp://10.0.0.1:8786'], 'use tls:// there'),
        (['--dask', 'tcp://127.0.0.1:8786', '--trust-students'], 'do not go together'),
        (['--tls-cert', 'cert.pem'], 'go with --dask'),
    ],
)
def test_conflicting_options_are_reported_before_grading(options, said, capsys):
    assert main(['grade', *options]) == 1
    assert said in capsys.readouterr().err
