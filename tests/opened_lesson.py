"""A lesson in a kernel that knows which notebook it belongs to, as in JupyterLab."""

import os

import nbformat
from jupyter_client.manager import start_new_kernel


class OpenedLesson:
    """A lesson in a kernel, opened as JupyterLab opens it."""

    def __init__(self, path):
        clean = {k: v for k, v in os.environ.items() if not k.startswith(('PYTEST_', 'MY_ROBOT_'))}
        self.cells = {cell.id: cell.source for cell in nbformat.read(path, as_version=4).cells}
        self.manager, self.client = start_new_kernel(
            kernel_name='python3', env=clean | {'JPY_SESSION_NAME': str(path)}
        )

    def run(self, name, source=None):
        """Run a cell; return its traceback in one line, or ''. `printed` has the text below it."""
        content = {
            **{'code': self.cells[name] if source is None else source, 'silent': False},
            **{'store_history': True, 'user_expressions': {}, 'allow_stdin': False},
        }
        message = self.client.session.msg('execute_request', content, metadata={'cellId': name})
        self.client.shell_channel.send(message)
        while (reply := self.client.get_shell_msg(timeout=60))['parent_header'].get(
            'msg_id'
        ) != message['header']['msg_id']:
            pass
        self.printed = ''
        while (told := self.client.get_iopub_msg(timeout=60))['content'].get(
            'execution_state'
        ) != 'idle' or told['parent_header'].get('msg_id') != message['header']['msg_id']:
            if told['msg_type'] == 'stream':
                self.printed += told['content']['text']
        self.printed = ' '.join(self.printed.split())
        return ' '.join(' '.join(reply['content'].get('traceback', ())).split())

    def close(self):
        self.client.stop_channels()
        self.manager.shutdown_kernel(now=True)
