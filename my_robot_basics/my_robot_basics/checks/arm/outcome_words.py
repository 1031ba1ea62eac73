"""Why a client of an action publishes another word than that for the status of its goal."""

_RESULT = 'publish the outcome when the result is there: future.result().status tells how it ended'
_AGAIN = (
    'publish the outcome of each goal when its result is there, also if it equals the last one'
)
_WORDS = {
    'cancelled': 'write canceled with one l, as ROS does',
    'succeed': 'write succeeded',
    'success': 'write succeeded',
}


def why_another_word(word: str, seen: str, *, last: str = '') -> str:
    """Return what to do if `seen` was published in place of `word`; '' stands for nothing.

    `last`: the outcome of the goal before.
    """
    if not seen and last == word:
        return _AGAIN
    if seen.lower() == word:
        return 'write the word in lower case'
    if seen.strip().lower() in _WORDS:
        return _WORDS[seen.strip().lower()]
    if seen.isdigit():
        return 'publish the word for the status, not its number'
    if word == 'rejected':
        return (
            'a goal that is not accepted has no result: look at goal_handle.accepted in the '
            'callback of send_goal_async'
        )
    return _RESULT
