#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What systemd hears from kinemapd: READY, a line of status, and signs of life of the detection loop. usage: notify_test.py KINEMAPD"""
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time


def heard_until(inbox, wanted, seconds=30):
    """The messages up to the one that begins with `wanted`."""
    messages, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            messages.append(inbox.recv(4096).decode())
        except TimeoutError:
            continue
        if messages[-1].startswith(wanted):
            return messages
    sys.exit(f"no {wanted} within {seconds} s; heard: {messages}")


with tempfile.TemporaryDirectory() as folder:
    path = str(pathlib.Path(folder) / "notify")
    inbox = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    inbox.bind(path)
    inbox.settimeout(0.5)
    daemon = subprocess.Popen([sys.argv[1], "--port", "0", "--suit-port", "0"], env=dict(os.environ, NOTIFY_SOCKET=path, WATCHDOG_USEC="400000"))
    try:
        assert heard_until(inbox, "READY=1")[-1] == "READY=1"
        status = heard_until(inbox, "STATUS=")[-1]
        assert "waiting for the suit" in status, status
        for _ in range(3):
            heard_until(inbox, "WATCHDOG=1")
        daemon.send_signal(signal.SIGHUP)
        heard_until(inbox, "RELOADING=1")
        heard_until(inbox, "READY=1")
        daemon.terminate()
        heard_until(inbox, "STOPPING=1")
        assert daemon.wait() == 0
    finally:
        daemon.kill()
