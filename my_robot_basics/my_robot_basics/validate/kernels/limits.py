"""How long a student's cell may take and how much it may print, with the reasons."""

STUDENT_CELL_TIMEOUT_SEC = 10.0
"""No answer of the course takes a second; a loop that waits for messages takes a few."""
VALIDATE_TIMEOUT_SEC = 2.5
"""How long *Validate* waits for a student's cell or function. If that takes longer, it is "not
checked", never wrong: grading waits longer. Time in which processes had to wait for a processor
does not count unless the code itself ran; at most, it is the grader's limit."""
VALIDATE_NEXT_TIMEOUT_SEC = 1.0
"""The same once another cell of the notebook was given up."""
VALIDATE_CHECKS_SEC = 20.0
"""How long *Validate* waits for all checks of an exercise, in time with a free processor; the
checks that are left are "not checked"."""
VALIDATE_CHECKS_MOST_SEC = 60.0
"""The same in wall time, which is the limit on a busy machine."""
BUILD_TIMEOUT_SEC = 90.0
"""For a locked cell that builds a package, which takes 2 to 4 s on an idle machine. If it takes
longer, it is built again in fresh rooms, and after that left to a person."""
STUDENT_CELLS_BUDGET_SEC = 120.0
"""For all student cells of a notebook together: grading a class has to end."""
REPLY_TIMEOUT_SEC = 10.0
"""How long the student's kernel may take to answer one request of a check: as for a cell."""
REPLIES_SEC = 90.0
"""For a check that does not end in CHECK_TIMEOUT_SEC: if replies took this long together, that is
the reason, and not a failure of the grader."""
CHECK_TIMEOUT_SEC = 150.0
"""A check has its own time limits, which are longer on a busy machine; this one ends a check in
which they fail."""
INTERRUPT_GRACE_SEC = 2.0
"""A kernel that ignores an interrupt for this long is killed; time in which processes had to wait
for a processor does not count."""
INTERRUPT_MOST_SEC = 10.0
"""The same in wall time: on a busy machine, it may take seconds to end a node."""
FLOOD_CHARACTERS = 10_000_000
"""A cell that prints more is stopped like one that never ends: reading all of it would keep a
processor busy. An answer prints some lines; a picture has about 100,000 characters."""
MAX_MESSAGE_BYTES = 64_000_000
"""ZMQ closes the connection on which a kernel sends a larger message: nothing more is received
from it. Pictures are far smaller."""
MAX_MESSAGE_PARTS = 200_000
"""Objects and lists in a message: each takes 20 times as much memory as its text."""
MAX_MESSAGES_WAITING = 2
"""ZMQ's receive queue for each channel, by default 1,000 messages: further ones wait in the memory
of the kernel that sends them, and the oldest are kept."""
MAX_NOTEBOOK_OUTPUT_CHARACTERS = 4_000_000
"""For all cells together; each cell also has its own limit."""
MAX_REPLY_CHARACTERS = 2 * 65_536
"""Characters of a reply as a Python literal: 64 kB, doubled because a backslash takes two."""
