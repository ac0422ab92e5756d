"""An end that comes even where native code never returns.

Fast DDS 2.14 can wait for ever in the removal of a participant when another one is discovered in
the same moment: `DomainParticipant::set_listener` holds the lock that the discovery callback
needs, and waits for that callback. rclpy keeps the interpreter's lock during it, so that no
thread and no signal handler of Python runs; a timer of the C library does.
"""

from __future__ import annotations

import ctypes
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

_SIGEV_THREAD = 2


class _TimeSpec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


class _TimerSpec(ctypes.Structure):
    _fields_ = (("interval", _TimeSpec), ("value", _TimeSpec))


class _SignalEvent(ctypes.Structure):
    """`struct sigevent` of Linux, 64 bytes; the value is the argument of the function."""

    _fields_ = (
        ("value", ctypes.c_size_t),
        ("signal", ctypes.c_int),
        ("notify", ctypes.c_int),
        ("function", ctypes.c_void_p),
        ("attributes", ctypes.c_void_p),
        ("rest", ctypes.c_char * 32),
    )


@contextmanager
def exit_after(seconds: float, code: int) -> Iterator[None]:
    """End the process with a code if the block takes longer than some seconds.

    Parameters
    ----------
    seconds : the limit
    code : exit code, 0 to 255

    Where the C library has no timers, as on systems other than Linux, the block has no limit.
    """
    library = ctypes.CDLL(None, use_errno=True)
    if sys.platform != "linux" or not hasattr(library, "timer_create"):
        yield
        return
    sys.stdout.flush()
    sys.stderr.flush()
    last_act = ctypes.cast(library._exit, ctypes.c_void_p)
    event = _SignalEvent(value=code, notify=_SIGEV_THREAD, function=last_act)
    timer = ctypes.c_void_p()
    if library.timer_create(time.CLOCK_MONOTONIC, ctypes.byref(event), ctypes.byref(timer)):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    whole = int(seconds)
    first = _TimeSpec(whole, round((seconds - whole) * 1e9))
    spec = _TimerSpec(value=first)
    library.timer_settime(timer, 0, ctypes.byref(spec), None)
    try:
        yield
    finally:
        library.timer_delete(timer)
