"""A small learning platform with LTI 1.3's Assignment and Grade Services, and faults on demand."""

import json
import threading
import time
from contextlib import contextmanager
from datetime import datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit
from uuid import uuid4

import jwt
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa

CLIENT = 'course-of-the-arm'
ASSERTION = 'urn:ietf:params:oauth:client-assertion-type:jwt-bearer'
SCOPE = 'https://purl.imsglobal.org/spec/lti-ags/scope'
HANGS_SEC = 1.5
PER_PAGE = 1
"""Columns per page: so few that a client has to follow the link to the next page."""


def new_key():
    """Return a private and a public key, in PEM."""
    key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    pem = serialization.Encoding.PEM
    private = key.private_bytes(
        pem, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    public = key.public_key().public_bytes(pem, serialization.PublicFormat.SubjectPublicKeyInfo)
    return private.decode(), public.decode()


class LtiPlatform:
    """The data of the platform, and its current fault."""

    def __init__(self, public):
        self.public = public
        self.users = {'4711', '4712', '4713'}
        self.columns = {}
        self.scores = {}
        """The last score, by column and user."""
        self.received = []
        """Every score that was accepted, in order."""
        self.requests = []
        self.tokens = {}
        self.seen_jti = set()
        self.mood = 'well'
        """Or `500`, `hangs`, `loses answers` (having stored a score), `talks nonsense`."""
        self.token_seconds = 3600
        self.address = ''

    def page(self, path, query):
        """Return (status, type, text) of a page for a browser, or None."""

    def token_for(self, form):
        """Return (status, response) to a client's token request."""
        if form.get('grant_type') != 'client_credentials':
            return 400, {'error': 'unsupported_grant_type'}
        if form.get('client_assertion_type') != ASSERTION:
            return 400, {'error': 'invalid_request'}
        try:
            claims = jwt.decode(
                form['client_assertion'],
                self.public,
                algorithms=['RS256'],
                audience=f'{self.address}/token',
                issuer=CLIENT,
                options={'require': ['exp', 'iat', 'jti', 'sub', 'iss', 'aud']},
            )
        except jwt.PyJWTError as error:
            return 401, {'error': 'invalid_client', 'error_description': str(error)}
        if claims['sub'] != CLIENT or claims['jti'] in self.seen_jti:
            return 401, {'error': 'invalid_client'}
        self.seen_jti.add(claims['jti'])
        token = uuid4().hex
        self.tokens[token] = set(form['scope'].split()), time.monotonic() + self.token_seconds
        return 200, {
            'access_token': token,
            'token_type': 'Bearer',
            'expires_in': self.token_seconds,
            'scope': form['scope'],
        }

    def may(self, token, scope):
        """Whether a token was issued here, is valid, and has this scope."""
        scopes, until = self.tokens.get(token, (set(), 0))
        return f'{SCOPE}/{scope}' in scopes and time.monotonic() < until

    def take(self, column, body):
        """Return (status, response) to a score."""
        if column not in self.columns:
            return 404, {'error': 'no such line item'}
        if body['userId'] not in self.users:
            return 400, {'error': f'{body["userId"]} is not enrolled'}
        when = datetime.fromisoformat(body['timestamp'])
        assert when.tzinfo
        before = self.scores.get((column, body['userId']))
        if before and when <= datetime.fromisoformat(before['timestamp']):
            return 409, {'error': 'there is a score that is as new'}
        assert body['scoreGiven'] >= 0
        assert body['gradingProgress'] == 'FullyGraded'
        self.scores[column, body['userId']] = body
        self.received.append((column, body['userId'], body['scoreGiven'], body['scoreMaximum']))
        return 200, None


class Handler(BaseHTTPRequestHandler):
    protocol_version = 'HTTP/1.1'

    def do_GET(self):
        self.answer(None)

    def do_POST(self):
        self.answer(self.rfile.read(int(self.headers['Content-Length'])).decode())

    def answer(self, body):
        platform = self.server.platform
        path, query = urlsplit(self.path).path, parse_qs(urlsplit(self.path).query)
        platform.requests.append(f'{self.command} {path}')
        if platform.mood == '500':
            return self.say(500, {'error': 'the database is away'})
        if platform.mood == 'hangs':
            time.sleep(HANGS_SEC)
            self.close_connection = True
            return None
        if platform.mood == 'talks nonsense':
            return self.say(200, ['down', 'for', 'maintenance'])
        if page := platform.page(path, query):
            status, kind, text = page
            return self.say(status, text.encode(), {'Content-Type': kind})
        if path == '/token':
            return self.say(*platform.token_for({k: v[0] for k, v in parse_qs(body).items()}))
        token = self.headers.get('Authorization', '').removeprefix('Bearer ')
        if not platform.may(token, 'score' if path.endswith('/scores') else 'lineitem'):
            return self.say(401, {'error': 'invalid_token'})
        if path == '/lineitems' and body is None:
            first = int(query.get('from', ['0'])[0])
            page = list(platform.columns.values())[first:][:PER_PAGE]
            more = first + PER_PAGE < len(platform.columns)
            url = f'<{platform.address}/lineitems?from={first + PER_PAGE}>; rel="next"'
            return self.say(200, page, {'Link': url} if more else {})
        if path == '/lineitems':
            column = f'/lineitems/{len(platform.columns) + 1}'
            made = json.loads(body) | {'id': platform.address + column}
            platform.columns[column] = made
            return self.say(201, made)
        status, said = platform.take(path.removesuffix('/scores'), json.loads(body))
        if platform.mood == 'loses answers':
            self.close_connection = True
            return None
        return self.say(status, said)

    def say(self, status, body, headers=()):
        content = b'' if body is None else body
        if not isinstance(content, bytes):
            content = json.dumps(body).encode()
        self.send_response(status)
        for name, value in dict(headers).items():
            self.send_header(name, value)
        self.send_header('Content-Length', str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


@contextmanager
def served(platform, port=0):
    """Serve the platform during the block; afterwards its port is closed."""
    server = ThreadingHTTPServer(('127.0.0.1', port), Handler)
    server.platform = platform
    platform.address = f'http://127.0.0.1:{server.server_port}'
    threading.Thread(target=server.serve_forever, args=[0.02], daemon=True).start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        server.server_close()
