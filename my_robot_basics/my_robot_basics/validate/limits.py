"""How long a student's cell may take and how much it may print, and why so much."""

STUDENT_CELL_TIMEOUT_SEC = 10.0
"""No answer of the course takes a second; a loop that waits for messages takes a few."""
VALIDATE_TIMEOUT_SEC = 2.5
"""*Validate* waits so long for a student's cell or function, and says that grading waits longer:
what takes more is not checked, and never called wrong. Time in which processes had to wait for a
processor does not count, unless the code itself had one, up to the grader's own limit, …"""
VALIDATE_NEXT_TIMEOUT_SEC = 1.0
"""… and so long where something has not returned already."""
VALIDATE_CHECKS_SEC = 20.0
"""*Validate* waits so long for the checks of an exercise together, as it waits for a cell: those
that are left are not checked there. …"""
VALIDATE_CHECKS_MOST_SEC = 60.0
"""… And so long on a machine that is too busy."""
BUILD_TIMEOUT_SEC = 90.0
"""A locked cell that builds a package has so long: 2 to 4 s of an idle machine. What takes longer
is built once more in fresh rooms, and then left to a person."""
STUDENT_CELLS_BUDGET_SEC = 120.0
"""The most that all student cells of a notebook may take together: a class has to end."""
REPLY_TIMEOUT_SEC = 10.0
"""How long the student's kernel may take to answer one question of a check: as for a cell."""
CHECK_TIMEOUT_SEC = 150.0
"""A check has time limits of its own, longer ones on a busy machine; this one ends a check that
lost them."""
INTERRUPT_GRACE_SEC = 2.0
"""A kernel that ignores an interrupt so long is killed. Time in which processes had to wait for a
processor does not count, …"""
INTERRUPT_MOST_SEC = 10.0
"""… within this: a busy machine may take seconds to end a node."""
FLOOD_CHARACTERS = 10_000_000
"""A cell that prints more is stopped as one that never ends: reading on would cost the class a
processor. An answer prints some lines, a picture is a tenth of a million."""
MAX_MESSAGE_BYTES = 64_000_000
"""A kernel that sends more at once is cut off: nothing that it says on that channel comes any
more. Pictures are far smaller."""
MAX_MESSAGE_PARTS = 200_000
"""Objects and lists in a message; each takes 20 times what it takes as text."""
MAX_MESSAGES_WAITING = 2
"""So many messages of each kind wait to be read; what else a kernel sends waits in its own memory,
and the oldest are kept: ZMQ would take a thousand."""
MAX_NOTEBOOK_OUTPUT_CHARACTERS = 4_000_000
"""Of all cells together; each has a limit of its own, and a notebook has many cells."""
MAX_REPLY = 2 * 65_536
"""Characters of a reply as a Python literal: 64 kB, and a backslash takes two."""
