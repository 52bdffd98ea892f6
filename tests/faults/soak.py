#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A working day, faster than real time: a simulated wearer goes round and round the same rooms, with two WebSocket clients and a journal.

Samples kinemapd every few seconds and judges: nothing is dropped by us, file handles stay, and after the first hour of stream (the map is known then)
memory grows by at most 5 % an hour. Exit code 1 when a criterion fails.

usage: soak.py KINEMAPD KINEMAP [--rounds N] [--speed S] [--samples FILE]
"""
import argparse
import base64
import json
import os
import pathlib
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

from kinemapd import Daemon, open_files

GROWTH_PER_HOUR = 0.05
SETTLED_S = 3600.0  # of stream


class Client(threading.Thread):
    """Subscribes to all topics, reads whatever comes and says now and then that it is there (an unsolicited pong, RFC 6455 5.5.3)."""

    ALIVE_EVERY_S = 5.0

    def __init__(self, port):
        super().__init__(daemon=True)
        self.bytes, self.ended = 0, False
        self.socket = socket.create_connection(("127.0.0.1", port))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /api/v1/stream HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        if b" 101 " not in self.socket.recv(4096):
            sys.exit("the stream was refused")
        text = b'{"op":"subscribe","topics":["map","pose","events","status"]}'
        self.socket.sendall(bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text)  # a mask of zeros
        self.start()

    def run(self):
        said = time.monotonic()
        while data := self.socket.recv(1 << 16):
            self.bytes += len(data)
            if time.monotonic() - said > self.ALIVE_EVERY_S:
                self.socket.sendall(bytes([0x8A, 0x80, 0, 0, 0, 0]))
                said = time.monotonic()
        self.ended = True


def sample(daemon, begin):
    status = daemon.get("status")
    stream, rings, solved = status["suit"]["stream"], status["rings"], status["map"]
    rss = status["process"]["rss_bytes"] / 1e6
    return {
        "wall_s": round(time.monotonic() - begin, 1),
        "stream_s": round(stream["frames"] / 120.0, 1),
        "solved_s": solved["time"],
        "rss_mb": round(rss, 1),
        "handles": open_files(daemon.process),
        "ring_frames": rings["frames"]["fill"],
        "ring_events": rings["events"]["fill"],
        "dropped": rings["frames"]["dropped"] + status["suit"]["socket"]["kernel_drops"] + stream["late"] + stream["incomplete"],
        "held_back": rings["events"]["held_back"],
        "key_poses": solved["key_poses"],
        "landmarks": solved["landmarks"],
        "closures": solved["loop_closures"],
        "solver_busy_s": solved["solver"]["busy_s"],
        "solver_longest_s": solved["solver"]["longest_s"],
        "skipped": status["clients"]["messages_skipped"],
    }


def judge(samples):
    """Problems in words, and the figures of the table in docs/reliability.md."""
    problems = []
    settled = [s for s in samples if s["solved_s"] >= SETTLED_S]
    last = samples[-1]
    if last["dropped"] > 0:
        problems.append(f"{last['dropped']} frames or datagrams were dropped")
    if len(settled) < 2 or settled[-1]["solved_s"] - settled[0]["solved_s"] < SETTLED_S / 4:
        print("too short to judge memory: the first hour of stream is left out")
        return problems
    # A single sample may catch the solver in the middle of an optimisation, with all that it takes for it. What has leaked is there in every sample
    # that follows, so the fewest handles count: a checkpoint that is being written has one more for a moment.
    quarter = (len(settled) + 3) // 4
    ends = [settled[:quarter], settled[-quarter:]]
    handles = [min(s["handles"] for s in end) for end in ends]
    rss = [statistics.median(s["rss_mb"] for s in end) for end in ends]
    at = [statistics.median(s["solved_s"] for s in end) / 3600.0 for end in ends]
    growth = (rss[1] / rss[0] - 1.0) / max(0.1, at[1] - at[0])
    print(f"memory {rss[0]:.1f} MB after {at[0]:.2f} h, {rss[1]:.1f} MB after {at[1]:.2f} h: {100 * growth:.1f} % an hour")
    print(f"handles {handles[0]} to {handles[1]}; landmarks {settled[0]['landmarks']} to {last['landmarks']}")
    if growth > GROWTH_PER_HOUR:
        problems.append(f"memory grows by {100 * growth:.1f} % an hour")
    if handles[1] > handles[0]:
        problems.append(f"file handles grew from {handles[0]} to {handles[1]}")
    return problems


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemapd")
    parser.add_argument("kinemap")
    parser.add_argument("--rounds", type=int, default=100, help="about two and a half minutes of stream each")
    parser.add_argument("--speed", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--every", type=float, default=10.0, help="s between samples")
    parser.add_argument("--patience", type=float, default=120.0, help="s that the solver may need after the stream has ended")
    parser.add_argument("--samples", help="file for the samples, as CSV")
    arguments = parser.parse_args()
    samples = []
    with tempfile.TemporaryDirectory() as name:
        config = pathlib.Path(name) / "config.json"
        config.write_text(json.dumps({"journal": {"directory": name + "/state", "min_free_mb": 0}}))
        daemon = Daemon(arguments.kinemapd, config, answers_within_s=60)
        clients = [Client(daemon.port) for _ in range(2)]
        begin = time.monotonic()
        wearer = subprocess.Popen(
            [arguments.kinemap, "sim", "--seed", str(arguments.seed), "--rooms", "1", "--rounds", str(arguments.rounds)]
            + ["--udp", f"127.0.0.1:{daemon.suit_port}", "--speed", str(arguments.speed)],
            stdout=subprocess.DEVNULL,
        )
        out = open(arguments.samples, "w") if arguments.samples else sys.stdout
        end = None
        while end is None or (time.monotonic() < end and samples[-1]["ring_events"] > 0):
            time.sleep(arguments.every)
            samples.append(sample(daemon, begin))
            if len(samples) == 1:
                print(",".join(samples[0]), file=out)
            print(",".join(str(v) for v in samples[-1].values()), file=out, flush=True)
            if end is None and wearer.poll() is not None:
                end = time.monotonic() + arguments.patience
        problems = judge(samples)
        if any(c.ended for c in clients):
            problems.append("a client was dropped")
        daemon.process.terminate()
        if daemon.process.wait(60) != 0:
            problems.append("kinemapd did not end well:\n" + "".join(daemon.log[-20:]))
    print(f"{samples[-1]['stream_s'] / 3600:.2f} h of stream: " + ("; ".join(problems) or "all well"))
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
