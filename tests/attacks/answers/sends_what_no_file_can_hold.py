"""Shows outputs with lone surrogates and paths as types and names, in messages it packs itself."""

kernel = get_ipython().kernel
CONTENTS = (
    rb'{"data": {"text/\ud800": "x", "../../x": "y"}, "metadata": {"\udcff": {"alt": "\udfff"}}}',
    rb'{"data": {"image/png": "?"}, "metadata": {"image/png": {"width": 1%b}}}' % (b'0' * 4000),
    rb'{"data": {"text/latex": "$\\input{/etc/passwd}$", "<script>": "<script>alert(1)"}}',
    rb'{"data": {"text/plain": "x"}, "metadata": {"\ud800": "x"}, "transient": {"display_id": {}}}',
)
for content in CONTENTS:
    kernel.session.send(kernel.iopub_socket, 'display_data', content, parent=kernel.get_parent())
