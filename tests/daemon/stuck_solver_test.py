#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A solver thread that hangs for good must trip the watchdog, although detection goes on. usage: stuck_solver_test.py KINEMAPD KINEMAP
77: skipped, since threads of other processes may not be held here (ptrace)."""
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time

HOLD = pathlib.Path(__file__).parents[1] / "system" / "hold_thread.py"


def beats(inbox, seconds):
    """How often WATCHDOG=1 comes within this time."""
    count, end = 0, time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            count += inbox.recv(4096) == b"WATCHDOG=1"
        except TimeoutError:
            pass
    return count


def until(inbox, log, pattern, seconds=60):
    """Waits for it in the log, and meanwhile takes what comes: a full inbox would hold the daemon."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = re.search(pattern, log.read_text())
        if found:
            return found
        beats(inbox, 0.2)
    sys.exit(f"no {pattern!r} within {seconds} s; the log:\n{log.read_text()}")


with tempfile.TemporaryDirectory() as folder:
    path, log = str(pathlib.Path(folder) / "notify"), pathlib.Path(folder) / "log"
    inbox = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    inbox.bind(path)
    inbox.settimeout(0.2)
    with open(log, "w", encoding="utf-8") as out:
        environment = dict(os.environ, NOTIFY_SOCKET=path, WATCHDOG_USEC="400000")
        daemon = subprocess.Popen([sys.argv[1], "--port", "0", "--suit-port", "0"], env=environment, stdout=out, stderr=out)
    processes = [daemon]
    try:
        port = until(inbox, log, r"suit on udp \S+ port (\d+)")[1]
        processes.append(subprocess.Popen([sys.argv[2], "sim", "--udp", f"127.0.0.1:{port}"], stdout=subprocess.DEVNULL))
        until(inbox, log, "receiving from")
        assert beats(inbox, 2) > 0
        holder = subprocess.Popen([sys.executable, HOLD, str(daemon.pid), "solver"], stderr=subprocess.PIPE, text=True)
        processes.append(holder)
        beats(inbox, 1)
        if holder.poll() is not None:
            print("SKIPPED:", holder.stderr.read())
            sys.exit(77)
        until(inbox, log, "the solver has work and does not move")
        beats(inbox, 1)  # those that were on their way
        assert beats(inbox, 3) == 0, "it is still fed"
    finally:
        for process in processes:
            process.kill()
