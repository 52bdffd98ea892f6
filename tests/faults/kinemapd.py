# SPDX-License-Identifier: Apache-2.0
"""What the fault campaigns share: a kinemapd to be broken, a suit that sends a recording, and the comparison of two maps."""
import json
import os
import re
import socket
import struct
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request

PLACE_M = 0.02  # an object is where it was


def datagrams(path):
    """(seconds, payload) of each packet of a classic pcap of UDP over IPv4 on Ethernet, as `kinemap sim` writes them."""
    data = path.read_bytes()
    unit = {0xA1B2C3D4: 1e-6, 0xA1B23C4D: 1e-9}[struct.unpack_from("<I", data)[0]]
    at = 24
    while at < len(data):
        seconds, fraction, size, _ = struct.unpack_from("<IIII", data, at)
        packet = data[at + 16 : at + 16 + size]
        header = 14 + 4 * (packet[14] & 15)
        yield seconds + fraction * unit, packet[header + 8 :]
        at += 16 + size


def open_files(process):
    """How many files and sockets the process has open."""
    return len(os.listdir(f"/proc/{process.pid}/fd"))


class Suit:
    """Sends a recording at `speed` from a thread of its own; can be held."""

    def __init__(self, recording, speed):
        self.recording, self.speed = recording, speed
        self.running, self.ended, self.sent_s = threading.Event(), False, 0.0
        self.port = None
        threading.Thread(target=self._send, daemon=True).start()

    def _send(self):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        first = self.recording[0][0]
        begin = time.monotonic()
        for when, payload in self.recording:
            if not self.running.is_set():
                held = time.monotonic()
                self.running.wait()
                begin += time.monotonic() - held
            wait = begin + (when - first) / self.speed - time.monotonic()
            if wait > 0:
                time.sleep(wait)
            out.sendto(payload, ("127.0.0.1", self.port))
            self.sent_s = when - first
        self.ended = True


class Daemon:
    """kinemapd on ports of its own choice."""

    def __init__(self, program, config, answers_within_s=10):
        self.answers_within_s = answers_within_s
        self.process = subprocess.Popen([program, "--config", config, "--port", "0", "--suit-port", "0"], stderr=subprocess.PIPE, text=True)
        self.log = []
        for line in self.process.stderr:
            self.log.append(line)
            ready = re.search(r"port (\d+), map at http://[^:]*:(\d+)/", line)
            if ready:
                self.suit_port, self.port = int(ready[1]), int(ready[2])
                break
        else:
            sys.exit("kinemapd did not start:\n" + "".join(self.log))
        threading.Thread(target=lambda: self.log.extend(self.process.stderr), daemon=True).start()

    def get(self, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/api/v1/{path}", timeout=self.answers_within_s) as answer:
            return json.load(answer)

    def pose_time(self):
        """Of the newest frame that was taken; 0 before the first."""
        try:
            return self.get("pose").get("time", 0.0)
        except urllib.error.HTTPError:
            return 0.0

    def get_text(self, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/{path}", timeout=self.answers_within_s) as answer:
            return answer.read().decode()

    def settle(self):
        """Until the map is settled, 3 s after the suit's last frame, however busy the machine is."""
        def at_rest():
            metrics = self.get_text("metrics")
            silence = float(re.search(r"^kinemap_suit_silence_seconds (\S+)", metrics, re.M)[1])
            waiting = sum(float(n) for n in re.findall(r"^kinemap_ring_depth\S* (\S+)", metrics, re.M))
            age = float(re.search(r"^kinemap_solver_entry_age_seconds (\S+)", metrics, re.M)[1])
            return silence > 4.0 and waiting == 0 and age == 0 and self.get("map")["time"] == self.pose_time()
        end, rests = time.monotonic() + 120, 0
        while rests < 3:  # between two entries the solver is at none
            rests = rests + 1 if at_rest() else 0
            if time.monotonic() > end:
                sys.exit("the map is not settled two minutes after the suit's last frame:\n" + "".join(self.log))
            time.sleep(0.1)

    def restored(self):
        end = time.monotonic() + 60
        while time.monotonic() < end:
            journal = self.get("status").get("journal", {})
            if journal.get("restored_entries") == journal.get("entries_to_restore"):
                time.sleep(0.05)  # the map is published right after the last entry
                return self.get("map"), self.get("trajectory")["poses"]
            time.sleep(0.02)
        sys.exit("the session is not back after a minute:\n" + "".join(self.log))

    def kill(self):
        self.process.kill()
        self.process.wait()


def moved(before, after):
    """Objects of the first map that have no twin within PLACE_M in the second, and the largest distance of those that have."""
    free, lost, farthest = list(after["objects"]), [], 0.0
    for o in before["objects"]:
        def distance(other):
            return max(abs(a - b) for a, b in zip(o["pose"]["position"], other["pose"]["position"]))
        twins = sorted((t for t in free if t["type"] == o["type"]), key=distance)
        if not twins or distance(twins[0]) > PLACE_M:
            lost.append(f"{o['type']} {o['id']}" + (f" is {distance(twins[0]):.3f} m off" if twins else " is gone"))
            continue
        free.remove(twins[0])
        farthest = max(farthest, distance(twins[0]))
    return lost + [f"{t['type']} {t['id']} is new" for t in free], farthest
