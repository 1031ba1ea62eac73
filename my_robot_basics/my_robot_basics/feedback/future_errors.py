"""Hints for exceptions of code that uses the answer of a service or action before it is there."""

from my_robot_basics.feedback.error_words import Case

OF_FUTURES = (
    Case(
        pattern=r"'NoneType' object has no attribute .*\.result\(\)",
        to_do=', so let add_done_callback call this function: call_async returns before the '
        'answer is there',
    ),
    Case(
        # a variable that got the result of a future too early, or of call(…, timeout_sec=…)
        pattern="'NoneType' object has no attribute "
        "'(?:reachable|elbow_up|elbow_down|accepted|status)'",
        to_do=', so use the answer in a function that add_done_callback calls: here it is None, '
        'because the answer was not there yet',
    ),
    Case(
        pattern="'Future' object (?:has no attribute|is not subscriptable)",
        to_do=', so take the answer out of the future with .result(), in the function that '
        'add_done_callback calls, or with `await` in a coroutine: before that, there is no answer',
    ),
    Case(
        pattern="'coroutine' object |str instance, coroutine found|iterable coroutine object",
        to_do=', so put `await` before the call of the async function: without it, nothing in it '
        'runs',
    ),
)
