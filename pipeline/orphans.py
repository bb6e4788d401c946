"""No process without the one that started it: the kernel kills it when its parent is gone.

`PR_SET_PDEATHSIG` (prctl(2), Linux) sends a signal when the thread that started the process ends, by whatever cause, so
whoever starts such a process does it in a thread that lives as long as it is wanted.  Other systems have no such
call: there a process whose parent was killed ends when it next reads from it.
"""

import ctypes
import os
import signal
import sys

PARENT = "PLANISH_PARENT"
"""The name in the environment under which a process is told the number of its parent."""
PR_SET_PDEATHSIG = 1
"""The number of the option in linux/prctl.h."""


def die_with_parent(parent: int) -> None:
    """Have this process killed when its parent, the process of that number, ends; end at once if it has ended."""
    if sys.platform != "linux":
        return
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)


def die_with_the_one_told() -> None:
    """Have this process killed when the parent ends that its environment names, if it names one."""
    named = os.environ.get(PARENT, "")
    if named.isdecimal():
        die_with_parent(int(named))
