"""The system calls that a room may make, by name and number; all others end with ENOSYS.

They are those that sample answers and lessons were seen to make, and related ones in Python's
os, threading, subprocess and socket, and in the libraries of NumPy and Matplotlib.

These are left out on purpose, though programs elsewhere use them:
- memory outside of any process's own, which a limit on processes would miss: shmget, msgget,
  semget, mq_open, memfd_create, vmsplice. Python's multiprocessing uses /dev/shm for semaphores;
- resources shared by the whole machine: io_setup, inotify_init, keyctl, sync;
- which pages of a file are in memory: preadv2 with RWF_NOWAIT, mincore, fadvise64 to evict them.
  All rooms read the same files: code left a hidden input there, and the next hand-in printed it;
- other processes' memory, namespaces, mounts, the machine's clock, name and modules, tracing;
- clone3, whose flags a filter can't read: the C library then calls clone.
"""

ALLOWED: dict[str, int] = dict(  # noqa: C408 - it reads better so
    # files and folders
    read=0, write=1, open=2, close=3, stat=4, fstat=5, lstat=6, lseek=8, ioctl=16,
    pread64=17, pwrite64=18, readv=19, writev=20, access=21, sendfile=40, fcntl=72,
    flock=73, fsync=74, fdatasync=75, truncate=76, ftruncate=77, getdents=78, getcwd=79,
    chdir=80, fchdir=81, rename=82, mkdir=83, rmdir=84, creat=85, link=86, unlink=87,
    symlink=88, readlink=89, chmod=90, fchmod=91, chown=92, fchown=93, lchown=94, umask=95,
    utime=132, mknod=133, statfs=137, fstatfs=138, setxattr=188, lsetxattr=189,
    fsetxattr=190, getxattr=191, lgetxattr=192, fgetxattr=193, listxattr=194,
    llistxattr=195, flistxattr=196, removexattr=197, lremovexattr=198, fremovexattr=199,
    getdents64=217, utimes=235, openat=257, mkdirat=258, mknodat=259,
    fchownat=260, futimesat=261, newfstatat=262, unlinkat=263, renameat=264, linkat=265,
    symlinkat=266, readlinkat=267, fchmodat=268, faccessat=269, splice=275, tee=276,
    utimensat=280, fallocate=285, preadv=295, pwritev=296, renameat2=316,
    copy_file_range=326, statx=332, close_range=436, openat2=437,
    faccessat2=439, fchmodat2=452,
    # pipes, and waiting for files
    poll=7, pipe=22, select=23, dup=32, dup2=33, epoll_create=213, epoll_wait=232,
    epoll_ctl=233, pselect6=270, ppoll=271, epoll_pwait=281, signalfd=282,
    timerfd_create=283, eventfd=284, timerfd_settime=286, timerfd_gettime=287,
    signalfd4=289, eventfd2=290, epoll_create1=291, dup3=292, pipe2=293, epoll_pwait2=441,
    # memory
    mmap=9, mprotect=10, munmap=11, brk=12, mremap=25, msync=26, madvise=28,
    mlock=149, munlock=150, mlockall=151, munlockall=152, get_mempolicy=239, membarrier=324,
    mlock2=325,
    # sockets
    socket=41, connect=42, accept=43, sendto=44, recvfrom=45, sendmsg=46, recvmsg=47,
    shutdown=48, bind=49, listen=50, getsockname=51, getpeername=52, socketpair=53,
    setsockopt=54, getsockopt=55, accept4=288, recvmmsg=299, sendmmsg=307,
    # processes and threads
    sched_yield=24, getpid=39, clone=56, fork=57, vfork=58, execve=59, exit=60, wait4=61,
    setpgid=109, getppid=110, getpgrp=111, setsid=112, getpgid=121, getsid=124,
    getpriority=140, setpriority=141, sched_setparam=142, sched_getparam=143,
    sched_setscheduler=144, sched_getscheduler=145, sched_get_priority_max=146,
    sched_get_priority_min=147, sched_rr_get_interval=148, prctl=157, arch_prctl=158,
    gettid=186, futex=202, sched_setaffinity=203, sched_getaffinity=204,
    set_tid_address=218, restart_syscall=219, exit_group=231, waitid=247,
    set_robust_list=273, get_robust_list=274, getcpu=309, sched_setattr=314,
    sched_getattr=315, execveat=322, rseq=334, pidfd_send_signal=424, pidfd_open=434,
    futex_waitv=449,
    # signals and timers
    rt_sigaction=13, rt_sigprocmask=14, rt_sigreturn=15, pause=34, nanosleep=35,
    getitimer=36, alarm=37, setitimer=38, kill=62, gettimeofday=96, times=100,
    rt_sigpending=127, rt_sigtimedwait=128, rt_sigqueueinfo=129, rt_sigsuspend=130,
    sigaltstack=131, tkill=200, time=201, timer_create=222, timer_settime=223,
    timer_gettime=224, timer_getoverrun=225, timer_delete=226, clock_gettime=228,
    clock_getres=229, clock_nanosleep=230, tgkill=234, rt_tgsigqueueinfo=297,
    # users and privileges, all of which were dropped before
    getuid=102, getgid=104, setuid=105, setgid=106, geteuid=107, getegid=108, setreuid=113,
    setregid=114, getgroups=115, setgroups=116, setresuid=117, getresuid=118, setresgid=119,
    getresgid=120, setfsuid=122, setfsgid=123, capget=125, capset=126,
    # limits and the machine
    uname=63, getrlimit=97, getrusage=98, sysinfo=99, setrlimit=160, prlimit64=302,
    getrandom=318,
    # for one more filter: `signals` sets it in a kernel that was started, not forked
    seccomp=317,
)  # fmt: skip
"""Numbers of x86-64, the only architecture that the ROS packages are built for."""
