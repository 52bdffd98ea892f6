#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the suit sends while kinemapd is dead must not be lost when systemd keeps its socket; here this script is systemd.

usage: kept_socket_test.py KINEMAPD KINEMAP
"""
import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "faults"))
from kinemapd import datagrams

# As systemd starts a service: the socket is descriptor 3 of the very process that the daemon becomes.
START = """import os, sys
kept = int(sys.argv[1])
if kept >= 0:
    os.dup2(kept, 3)
    kept == 3 or os.close(kept)
    os.environ.update(LISTEN_PID=str(os.getpid()), LISTEN_FDS="1", LISTEN_FDNAMES="suit")
os.execv(sys.argv[2], sys.argv[2:])"""


class Manager:
    def __init__(self, folder):
        self.path, self.kept, self.log = str(folder / "notify"), -1, folder / "log"
        self.inbox = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.inbox.bind(self.path)
        self.inbox.settimeout(0.2)

    def take(self):
        """One message; what is in it."""
        try:
            data, sockets, _, _ = socket.recv_fds(self.inbox, 4096, 4)
        except TimeoutError:
            return ""
        text = data.decode()
        if "FDSTOREREMOVE=1" in text and "FDNAME=suit" in text:
            os.close(self.kept)
            self.kept = -1
        if "FDSTORE=1" in text.split("\n"):
            assert "FDNAME=suit" in text and self.kept < 0, text
            self.kept = sockets.pop()
        for other in sockets:  # a barrier ends when it is closed
            os.close(other)
        return text

    def start(self, program, config, suit_port):
        environment = dict(os.environ, NOTIFY_SOCKET=self.path)
        command = [sys.executable, "-c", START, str(self.kept), program, "--config", str(config), "--port", "0", "--suit-port", str(suit_port)]
        with self.log.open("w") as log:
            process = subprocess.Popen(command, env=environment, stderr=log, pass_fds=[self.kept] if self.kept >= 0 else [])
        end = time.monotonic() + 30
        while "READY=1" not in self.take():
            if time.monotonic() > end or process.poll() is not None:
                sys.exit("kinemapd did not start:\n" + self.log.read_text())
        ports = re.search(r"port (\d+), map at http://[^:]*:(\d+)/", self.log.read_text())
        return process, int(ports[1]), int(ports[2])


def status(port):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/v1/status", timeout=30) as answer:
        return json.load(answer)


def frames(port):
    return status(port)["suit"]["stream"]["frames"]


def is_written(port, count):
    """So many frames at least, and all that came of them is in the journal."""
    now = status(port)
    return now["tracker"]["frames"] >= count and now["journal"]["lag_entries"] == 0


def eventually(holds):
    end = time.monotonic() + 30
    while not holds() and time.monotonic() < end:
        time.sleep(0.1)
    return holds()


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    subprocess.run([sys.argv[2], "sim", "--seed", "3", "--packet-loss", "0", "--out", name], check=True, stdout=subprocess.DEVNULL)
    suit = [payload for _, payload in datagrams(folder / "session.pcap") if payload[4:6] == b"02"]
    config = folder / "config.json"
    config.write_text(json.dumps({"journal": {"directory": name + "/state", "min_free_mb": 0}}))
    out, manager = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), Manager(folder)
    daemon, suit_port, port = manager.start(sys.argv[1], config, 0)
    try:
        assert manager.kept >= 0, "it gave no socket to keep"
        for payload in suit[:300]:
            out.sendto(payload, ("127.0.0.1", suit_port))
        assert eventually(lambda: is_written(port, 295)), status(port)  # the newest wait for those that may come late
        daemon.kill()
        daemon.wait()
        for payload in suit[300:400]:
            out.sendto(payload, ("127.0.0.1", suit_port))
        daemon, again, port = manager.start(sys.argv[1], config, suit_port)
        assert again == suit_port and manager.kept >= 0
        assert eventually(lambda: frames(port) >= 95), f"{frames(port)} of 100 frames that came meanwhile"
        assert eventually(lambda: "the suit's stream goes on" in manager.log.read_text()), manager.log.read_text()
        # Another address on the same port: the kept one is let go of, or the port would be taken.
        daemon.kill()
        daemon.wait()
        config.write_text(json.dumps({"suit": {"address": "127.0.0.1"}, "journal": {"directory": name + "/state", "min_free_mb": 0}}))
        daemon, again, port = manager.start(sys.argv[1], config, suit_port)
        assert again == suit_port and manager.kept >= 0 and frames(port) == 0
    finally:
        daemon.kill()
