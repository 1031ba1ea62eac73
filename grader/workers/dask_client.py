"""Connect to a Dask scheduler, and only if others can neither read nor send messages."""

import ipaddress
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from grader.common.errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client

CONNECT_TIMEOUT_SEC = 30.0
"""How long a scheduler may take to answer, or a first worker to connect."""


@dataclass(frozen=True)
class Certificates:
    """Files for TLS, as `dask scheduler` takes them; for those not given, Dask's configuration."""

    ca_file: str | None = None
    cert: str | None = None
    key: str | None = None


def check_address(address: str) -> None:
    """Raise ClusterError if others could read what is sent to an address, or send to it."""
    parts = urlsplit(address)
    if parts.scheme not in ('tcp', 'tls') or not parts.hostname:
        raise ClusterError(
            f'{address} is not the address of a scheduler: expected tls://HOST:8786, or on this '
            'machine tcp://127.0.0.1:8786'
        )
    if parts.scheme == 'tcp' and not _is_loopback(parts.hostname):
        raise ClusterError(
            f'{address} is another machine, and anyone who can reach it could read the hidden '
            'tests and run programs on the workers: use tls:// there. Start `dask scheduler` and '
            '`dask worker` with --tls-ca-file, --tls-cert and --tls-key, and name the same three '
            'here.'
        )


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == 'localhost'


def connect(address: str, certificates: Certificates) -> 'Client':
    """Return a client of a scheduler. Raises ClusterError if there is none, or no Dask."""
    try:
        from distributed import Client, Security
    except ModuleNotFoundError as error:
        raise ClusterError(
            f'--dask needs Dask, which this Python lacks ({error}): install it with '
            '.venv/bin/python -m pip install -r environment.txt'
        ) from None
    security = Security()
    if address.startswith('tls:'):
        named = {
            'tls_ca_file': certificates.ca_file,
            'tls_client_cert': certificates.cert,
            'tls_client_key': certificates.key,
        }
        security = Security(
            require_encryption=True, **{name: file for name, file in named.items() if file}
        )
        if not all(getattr(security, name) for name in named):  # from Dask's configuration, too
            raise ClusterError(
                f'{address} needs certificates: name them with --tls-ca-file, --tls-cert and '
                "--tls-key, or in Dask's own configuration"
            )
    try:
        return Client(
            address,
            security=security,
            timeout=CONNECT_TIMEOUT_SEC,
            set_as_default=False,
            name='course',
        )
    except (OSError, ValueError) as error:
        why = str(error).partition('\n')[0]
        if 'certificate' in why:
            raise ClusterError(
                f'the scheduler at {address} has a certificate of another authority than that of '
                '--tls-ca-file, or is another program. Sign those of the scheduler, the workers '
                'and this machine by one authority, and name it to each of them.'
            ) from None
        raise ClusterError(
            f'there is no scheduler at {address} that answers ({why}). Start one: '
            '.venv/bin/dask scheduler'
        ) from None
