"""What a submission may use, and why so much; `validate.kernels.limits` has a cell's limits."""

import resource

SUBMISSION_TIMEOUT_SEC = 1_800.0
"""For all of a submission; each part of it has a shorter limit of its own."""

MAX_REASON_CHARACTERS = 20_000
"""For one reason; a check's own are a line or two, and an error's text is cut at half of this."""
MAX_NOTES, MAX_NOTE_CHARACTERS = 1_000, 2_000
"""Notes on one check, or on how a notebook was restored, and the length of each."""
MAX_TASK_BYTES = 100_000_000
"""Of a task as JSON: a notebook to be graded, with its pasted pictures and files."""
MAX_RESULT_BYTES = 100_000_000
"""Of a graded notebook as JSON: its text, pasted pictures, and outputs within their limits."""
MAX_RESULT_PARTS = 200_000
"""Objects and lists in a result: each takes 200 times its text's memory. A lesson has some 500."""

ROOM_MEMORY_BYTES = 2 * 2**30
"""For all processes of a room together; the kernel of a lesson uses 0.15 GB."""
ROOM_SOCKET_BYTES = 256 * 2**20
"""For data waiting in a room's sockets, if Linux counts it separately; a lesson: under 1 MB."""
ROOM_TERMINALS = 32
"""Pseudo-terminals, one for each `!` command that runs: the whole machine has some thousands."""
ROOM_PROCESSES = 256
"""Processes and threads of a room together; a lesson has some 60."""
CPU_WEIGHT = 100
"""cpu.weight of each room; a sandbox has twice that. So the test's kernel gets its half of the
processor, however many processes a student starts."""
ROOM_DISK_BYTES = 64 * 2**20
"""All that a room can write, to a file system in memory: logs, caches and plots take 2 MB."""
ROOM_FILES = 8_192
"""Files and folders in a room: each takes memory in addition to its content."""

SUBMISSION_MEMORY_BYTES = 600 * 2**20
"""Set aside for each submission in flight; the two kernels of a lesson use half of it."""
IN_FLIGHT_EACH = 2
"""How many submissions a worker grades at a time, if memory allows: each mostly waits."""
MOST_IN_FLIGHT_EACH = 5
"""The same, if processors are idle nevertheless. If processors are short, nodes follow the
simulated clock too slowly, and are judged on the wall clock."""
MOST_IN_FLIGHT = 60
"""The most in all, unless IN_FLIGHT_EACH of each worker is more: each submission needs a ROS
domain, and a machine has 101."""
IDLE_SHARE, BUSY_SHARE = 0.5, 0.75
"""The share of time in which a process had to wait for a processor: below the first, more
submissions are graded at a time, above the second fewer."""

_RLIMIT_LOCKS = 10  # Python has no name for it
PROCESS_LIMITS = {
    resource.RLIMIT_AS: 3 * 2**30,  # of each process, reserved or used; a lesson: under 1 GB
    resource.RLIMIT_DATA: 3 * 2**30,  # a part of RLIMIT_AS
    resource.RLIMIT_STACK: 8 * 2**20,  # of each thread: as in a login session
    resource.RLIMIT_NPROC: ROOM_PROCESSES,
    resource.RLIMIT_CPU: 300,  # seconds of each process; all end with their submission anyway
    resource.RLIMIT_FSIZE: ROOM_DISK_BYTES,  # no file can be larger than the disk
    resource.RLIMIT_NOFILE: 1_024,  # as in a login session; 30 nodes take 400
    resource.RLIMIT_CORE: 0,  # core dumps are never read
    resource.RLIMIT_MEMLOCK: 0,  # locked memory cannot be reclaimed
    resource.RLIMIT_MSGQUEUE: 0,  # message queues outlive processes
    resource.RLIMIT_SIGPENDING: 1_024,  # they wait in the kernel's memory; a lesson: none
    resource.RLIMIT_RTPRIO: 0,  # a real-time process would keep all others from running
    resource.RLIMIT_RTTIME: 0,
    resource.RLIMIT_NICE: 0,  # no higher priority than other processes
    resource.RLIMIT_RSS: 3 * 2**30,  # Linux does not enforce this limit
    _RLIMIT_LOCKS: 1_024,  # nor this one
}
"""What Linux enforces in each process of a student's room: a value for each of its limits."""
OWN_FILES = 16_384
"""How many files a process of the grader may have open."""

OUT_OF_MEMORY_SCORE = 1_000
"""If the machine runs out of memory, Linux kills processes with this oom_score_adj first."""


def process_limits() -> dict[int, int]:
    """Return PROCESS_LIMITS, or our own hard limit if that is lower: it can't be raised."""
    limits = {
        kind: _allowed(most, resource.getrlimit(kind)[1]) for kind, most in PROCESS_LIMITS.items()
    }
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    limits[resource.RLIMIT_NOFILE] = _allowed(limits[resource.RLIMIT_NOFILE], hard // 2)
    return limits


def raise_own_file_limit() -> None:
    """Raise our own soft limit of open files above that of rooms.

    Linux counts files in flight over sockets by user, and a room may have the same user as we do:
    a process whose user has more of them in flight than its own limit can't send files at all.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OWN_FILES if hard == resource.RLIM_INFINITY else min(OWN_FILES, hard)
    if resource.RLIM_INFINITY != soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def prlimit_command() -> list[str]:
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
