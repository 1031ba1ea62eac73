"""Sends messages in which each part has a wrong type, on each of its sockets."""

kernel = get_ipython().kernel
parent = kernel.get_parent()
CONTENTS = [
    *(None, 7, [], 'x', {}),
    {'name': [], 'text': {}},
    {'name': 'stdout', 'text': 7, 'data': [], 'metadata': 'x'},
    {'data': {'text/plain': []}, 'transient': {'display_id': []}},
    {'ename': 1, 'evalue': 2, 'traceback': 'x', 'execution_state': []},
    {'ename': 'a', 'evalue': 'b', 'traceback': [{}, None, [1]]},
    {'status': [], 'user_expressions': 7, 'wait': {}, 'prompt': []},
]
KINDS = ['stream', 'display_data', 'error', 'status', 'clear_output', 'update_display_data']
KINDS += ['execute_result', 'execute_reply', 'input_request', 'comm_open', 7, None, ['x'], {}]
for kind in KINDS:
    for content in CONTENTS:
        for told in (parent, {'msg_id': parent['header']['msg_id']}, 7, [], None):
            for sockets in (kernel.iopub_socket, kernel.stdin_socket):
                try:
                    kernel.session.send(sockets, kind, content, parent=told)
                except Exception:
                    pass
