"""Messages that come out of a node although nobody sent them."""

from collections.abc import Hashable, Sequence, Set

FEWEST_INVENTED = 3
"""This many messages that nobody sent are a fault. Fewer may be older than the subscription."""
FIRST_SEC, LATE_SEC = 1.0, 0.2
"""How long messages of other publishers may be missing from those that are known to be sent, and
how long after that an unknown message may come out of a slow node, in s."""


def has_invented(
    out: Sequence[tuple[Hashable, int]],
    *,
    sent: Sequence[tuple[Hashable, int]],
    own: Set[Hashable],
    began_ns: int,
) -> bool:
    """Whether messages came out that nobody sent; `out` and `sent` are contents and send times.

    What another publisher sent before its first message in `sent` is unknown. So messages count
    only after that one, or after FIRST_SEC if that is sooner. The check sent those in `own`.
    """
    of_others_ns = (ns for what, ns in sent if what not in own)
    received_ns = min(next(of_others_ns, 0), began_ns + round(FIRST_SEC * 1e9))
    since_ns = received_ns + round(LATE_SEC * 1e9)
    known = own | {what for what, _ in sent}
    invented = [what for what, sent_ns in out if sent_ns > since_ns and what not in known]
    return len(invented) >= FEWEST_INVENTED
