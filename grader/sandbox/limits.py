"""What a submission may use up, and why so much; a cell's limits are those of Validate, too."""

import resource

SUBMISSION_TIMEOUT_SEC = 1_800.0
"""Each part of a submission has a limit of its own; this one bounds all of it."""

MAX_REASON_CHARACTERS = 20_000
"""Of one reason; a check's own are a line or two, and an error's text is cut at half of that."""
MAX_NOTES, MAX_NOTE_CHARACTERS = 1_000, 2_000
"""What is reported about one check, or about how a notebook was restored."""
MAX_TASK_BYTES = 100_000_000
"""A notebook that is to be graded as JSON, with its pasted pictures and files."""
MAX_RESULT_BYTES = 100_000_000
"""A graded notebook as JSON: its text, pasted pictures, and outputs within their own limits."""
MAX_RESULT_PARTS = 200_000
"""Objects and lists in it: one takes 200 times what it takes as text. A lesson: some 500."""

ROOM_MEMORY_BYTES = 2 * 2**30
"""All processes of a room together; the kernel of a lesson uses 0.15 GB."""
ROOM_SOCKET_BYTES = 256 * 2**20
"""What waits in a room's sockets, where Linux counts that aside; a lesson: under 1 MB."""
ROOM_TERMINALS = 32
"""Pseudo-terminals, one for each command after a `!`: the machine has some thousands for all."""
ROOM_PROCESSES = 256
"""Processes and threads of a room together; a lesson: some 60."""
CPU_WEIGHT = 100
"""What each room may have of the processor beside the other one, and a sandbox twice that beside
others: however many processes a student starts, the test's kernel has its half."""
ROOM_DISK_BYTES = 64 * 2**20
"""All that a room can write, on a file system in memory: logs, caches and plots take 2 MB."""
ROOM_FILES = 8_192
"""Files and folders in it: each takes memory that its size does not tell."""

SUBMISSION_MEMORY_BYTES = 600 * 2**20
"""Set aside for each submission that is in flight; the two kernels of a lesson use half of it."""
IN_FLIGHT_EACH = 2
"""How many a worker process grades at a time, memory permitting: most of each is waiting."""
MOST_IN_FLIGHT_EACH = 5
"""How many where processors stand idle all the same. Where they are short, nodes follow the
robot's clock too slowly, and are judged on the wall clock."""
MOST_IN_FLIGHT = 60
"""No more than so many in all, unless there are that many to begin with: each needs a ROS domain,
and a machine has 101."""
IDLE_SHARE, BUSY_SHARE = 0.5, 0.75
"""The part of the time in which some process had to wait for a processor: below the first there is
room for more submissions, above the second there are too many."""

_RLIMIT_LOCKS = 10  # Python has no name for it
PROCESS_LIMITS = {
    resource.RLIMIT_AS: 3 * 2**30,  # of each process, asked for or used; a lesson: under 1 GB
    resource.RLIMIT_DATA: 3 * 2**30,  # is a part of that
    resource.RLIMIT_STACK: 8 * 2**20,  # of each thread: what a login has
    resource.RLIMIT_NPROC: ROOM_PROCESSES,
    resource.RLIMIT_CPU: 300,  # seconds of each process; nothing outlives its submission anyway
    resource.RLIMIT_FSIZE: ROOM_DISK_BYTES,  # no file can be larger than the disk
    resource.RLIMIT_NOFILE: 1_024,  # what a login has; 30 nodes take 400
    resource.RLIMIT_CORE: 0,  # nobody would look at it
    resource.RLIMIT_MEMLOCK: 0,  # locked memory cannot be taken back
    resource.RLIMIT_MSGQUEUE: 0,  # message queues outlive processes
    resource.RLIMIT_SIGPENDING: 1_024,  # what waits is the kernel's memory; a lesson: none
    resource.RLIMIT_RTPRIO: 0,  # a priority of real time keeps all others waiting
    resource.RLIMIT_RTTIME: 0,
    resource.RLIMIT_NICE: 0,  # nobody comes before others
    resource.RLIMIT_RSS: 3 * 2**30,  # Linux does not look at this one, …
    _RLIMIT_LOCKS: 1_024,  # … nor at this one
}
"""What Linux enforces in each process of a student's room: all that it has limits for."""
OWN_FILES = 16_384
"""What may be open in a process of ours."""

OUT_OF_MEMORY_SCORE = 1_000
"""Where the machine's memory runs out, Linux ends such processes before any other."""


def process_limits() -> dict[int, int]:
    """Return PROCESS_LIMITS; less where our own hard limit is less: nobody can raise that."""
    limits = {
        kind: _allowed(most, resource.getrlimit(kind)[1]) for kind, most in PROCESS_LIMITS.items()
    }
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    limits[resource.RLIMIT_NOFILE] = _allowed(limits[resource.RLIMIT_NOFILE], hard // 2)
    return limits


def let_us_open_more() -> None:
    """Raise our own limit of open files, as far as rooms can't get.

    Linux counts what is on its way through sockets by user, and that may be a room's user, too:
    who has more under way than its own limit can send no file any more, no matter whose they are.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OWN_FILES if hard == resource.RLIM_INFINITY else min(OWN_FILES, hard)
    if resource.RLIM_INFINITY != soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def limited() -> list[str]:
    """Return the beginning of a command that runs the rest within PROCESS_LIMITS."""
    names = {number: name.removeprefix('RLIMIT_').lower() for name, number in _constants()}
    return [
        'prlimit',
        *(f'--{names[kind]}={most}:{most}' for kind, most in process_limits().items()),
    ]


def _allowed(most: int, hard: int) -> int:
    return most if hard == resource.RLIM_INFINITY else min(most, hard)


def _constants() -> list[tuple[str, int]]:
    names = [name for name in dir(resource) if name.startswith('RLIMIT_') and 'OFILE' not in name]
    found = [(name, getattr(resource, name)) for name in names]
    return [*found, ('nofile', resource.RLIMIT_NOFILE), ('locks', _RLIMIT_LOCKS)]
