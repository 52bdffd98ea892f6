#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Stops one thread of a process, all others go on (ptrace; SIGSTOP would stop them all), until the process ends.

Usage: hold_thread.py PID NAME    exits with 1 when there is no such thread, or when nobody ended the process within a minute
"""
import ctypes
import os
import sys
import time

PTRACE_SEIZE, PTRACE_INTERRUPT = 0x4206, 0x4207


def thread_of(pid, name):
    for tid in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{tid}/comm", encoding="utf-8") as file:
            if file.read().strip() == name:
                return int(tid)
    sys.exit(f"process {pid} has no thread {name}")


def main():
    pid = int(sys.argv[1])
    tid = thread_of(pid, sys.argv[2])
    ptrace = ctypes.CDLL(None, use_errno=True).ptrace
    ptrace.argtypes = [ctypes.c_long] * 4
    for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
        if ptrace(request, tid, 0, 0) != 0:
            sys.exit(f"ptrace: {os.strerror(ctypes.get_errno())}")
    for _ in range(600):
        ended, _status = os.waitpid(tid, os.WNOHANG | 0x40000000)  # __WALL: threads too
        if not os.path.exists(f"/proc/{pid}/task/{tid}") or (ended and (os.WIFSIGNALED(_status) or os.WIFEXITED(_status))):
            return
        time.sleep(0.1)
    sys.exit("the process still lives after a minute")


main()
