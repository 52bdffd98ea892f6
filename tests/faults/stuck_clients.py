#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Clients that hold connections, send slowly, send nonsense or take nothing, all at once, while the suit sends and one client asks as usual.

The daemon must go on: every request of the one client is answered, no frame of the suit is dropped, its memory stays bounded, and once the others are
gone it has no connection and no file of theirs.

usage: stuck_clients.py KINEMAPD KINEMAP [--clients N] [--seconds S] [--seed SEED]
"""
import argparse
import json
import os
import pathlib
import random
import re
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time

from kinemapd import open_files

TOKEN = "reader-of-the-fault-campaign"
UPGRADE = (
    "GET {path}?token=" + TOKEN + " HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{more}\r\n"
)
GROWTH_BYTES = 200 << 20  # 64 clients may have 2 MiB each under way, and TLS its buffers


class Daemon:
    """kinemapd with TLS and tokens, which it wants of everybody."""

    def __init__(self, program, kinemap, folder):
        config = folder / "config.json"
        paired = json.loads(subprocess.run([kinemap, "pair", "--config", config, "--host", "127.0.0.1", "--json"], check=True, capture_output=True).stdout)
        drop_in = json.loads(re.sub(r"^//.*\n", "", pathlib.Path(paired["drop_in"]).read_text()))
        pathlib.Path(paired["drop_in"]).unlink()
        tokens = pathlib.Path(drop_in["api"]["tokens"])
        tokens.write_text(f"read {TOKEN}\n")
        api = drop_in["api"] | {"address": "127.0.0.1", "auth": "always", "max_clients": 64, "max_clients_per_address": 4}
        config.write_text(json.dumps({"suit": {"address": "127.0.0.1"}, "api": api, "log": {"level": "trace"}}))
        self.log_path = folder / "log"
        with self.log_path.open("w") as log:
            self.process = subprocess.Popen([program, "--config", config, "--port", "0", "--suit-port", "0"], stderr=log)
        self.suit_port, self.port = self.ports()
        self.tls = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        self.tls.check_hostname = False
        self.tls.load_verify_locations(drop_in["api"]["certificate"])

    def ports(self):
        end = time.monotonic() + 60
        while time.monotonic() < end and self.process.poll() is None:
            found = re.search(r"port (\d+), map at https://[^:]*:(\d+)/", self.log_path.read_text())
            if found:
                return int(found[1]), int(found[2])
            time.sleep(0.05)
        sys.exit("kinemapd did not start:\n" + self.log_path.read_text())

    def connect(self, source, tls=True):
        plain = socket.create_connection(("127.0.0.1", self.port), timeout=30, source_address=(source, 0))
        return self.tls.wrap_socket(plain) if tls else plain

    def get(self, path, source="127.0.0.1"):
        """The answer's JSON; None when the daemon does not give one."""
        try:
            with self.connect(source) as connection:
                connection.sendall(f"GET /api/v1/{path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\nConnection: close\r\n\r\n".encode())
                answer = b""
                while chunk := connection.recv(65536):
                    answer += chunk
        except OSError:
            return None
        head, _, body = answer.partition(b"\r\n\r\n")
        return json.loads(body) if head.startswith(b"HTTP/1.1 200") else None


class StuckClient(threading.Thread):
    """Comes again whenever the daemon has closed it."""

    def __init__(self, daemon, number, stop, seed):
        super().__init__(daemon=True)
        self.kinemapd, self.stop, self.random = daemon, stop, random.Random(f"{seed} {number}")
        self.source = f"127.0.{1 + number // 20}.1"  # of every address more than may be
        self.kind = self.KINDS[number % len(self.KINDS)]
        self.rounds = 0

    def run(self):
        while not self.stop.is_set():
            try:
                with self.kinemapd.connect(self.source, tls=self.kind not in (type(self).silent, type(self).half_handshake)) as connection:
                    connection.settimeout(1.0)
                    self.kind(self, connection)
            except OSError:
                pass  # closed, which is right
            self.rounds += 1
            self.stop.wait(0.2)

    def hold(self, connection):
        while not self.stop.is_set():
            try:
                if not connection.recv(1):
                    return
            except TimeoutError:
                pass

    def silent(self, connection):
        self.hold(connection)

    def half_handshake(self, connection):
        connection.sendall(b"\x16\x03\x01\x02\x00\x01\x00")
        self.hold(connection)

    def slow_header(self, connection):
        text = "GET /api/v1/map HTTP/1.1\r\nHost: localhost\r\n" + "X: y\r\n" * 1000
        for letter in text:
            if self.stop.wait(0.2):
                return
            connection.sendall(letter.encode())

    def slow_body(self, connection):
        connection.sendall(b"POST /api/v1/map HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10000\r\n\r\n")
        while not self.stop.wait(0.2):
            connection.sendall(b"x")

    def no_reader(self, connection):
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        for _ in range(200):
            connection.sendall(f"GET /api/v1/export/scene.glb HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\n\r\n".encode())
        self.stop.wait(20)

    def websocket(self, connection, path="/api/v1/stream", more=""):
        connection.sendall(UPGRADE.format(path=path, more=more).encode())
        connection.recv(4096)

    @staticmethod
    def frame(payload, first=0x81):
        """A masked frame; the mask is zero."""
        size = len(payload)
        length = bytes([0x80 | size]) if size < 126 else bytes([0x80 | 126]) + size.to_bytes(2, "big") if size < 65536 else bytes([0x80 | 127]) + size.to_bytes(8, "big")
        return bytes([first]) + length + bytes(4) + payload

    def stream_no_reader(self, connection):
        self.websocket(connection)
        connection.sendall(self.frame(b'{"op":"subscribe","topics":["map","pose","body","status","events"],"rate_hz":240}'))
        self.stop.wait(25)

    def stream_nonsense(self, connection):
        self.websocket(connection)
        for _ in range(50):
            connection.sendall(self.frame(self.random.randbytes(self.random.randrange(1, 5000)), self.random.choice((0x81, 0x82, 0x01, 0x80, 0xC1, 0x83, 0x88))))

    def foxglove_nonsense(self, connection):
        self.websocket(connection, "/", "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n")
        for _ in range(50):
            text = self.random.choice((b"{}", b'{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1e99}]}', b"[" * 3000, b"\xff\xfe", b'{"op":'))
            connection.sendall(self.frame(text, self.random.choice((0x81, 0x82))))
            connection.sendall(self.frame(self.random.randbytes(40), 0x82))

    def http_nonsense(self, connection):
        request = bytearray(f"GET /api/v1/objects?near=1,2 HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\nContent-Length: 5\r\n\r\nabcde".encode())
        for _ in range(1 + self.random.randrange(20)):
            request[self.random.randrange(len(request))] = self.random.randrange(256)
        connection.sendall(bytes(request) * 3)
        self.hold(connection)

    def huge_header(self, connection):
        connection.sendall(b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * 100000)

    def tls_nonsense(self, connection):
        plain = connection.unwrap() if self.random.random() < 0.2 else socket.socket(fileno=os.dup(connection.fileno()))
        with plain:
            plain.sendall(b"\x17\x03\x03\x10\x00" + self.random.randbytes(4096))

    KINDS = (silent, half_handshake, slow_header, slow_body, no_reader, stream_no_reader, stream_nonsense, foxglove_nonsense, http_nonsense, huge_header, tls_nonsense)


def ask_as_usual(daemon, seconds):
    """So many requests, one after the other, and how many of them were not answered and the longest time that one took."""
    asked, unanswered, longest_s = 0, 0, 0.0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        begin = time.monotonic()
        unanswered += daemon.get("map") is None
        asked += 1
        longest_s = max(longest_s, time.monotonic() - begin)
        time.sleep(0.1)
    return asked, unanswered, longest_s


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemapd")
    parser.add_argument("kinemap")
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        daemon = Daemon(arguments.kinemapd, arguments.kinemap, pathlib.Path(name))
        sim = subprocess.Popen([arguments.kinemap, "sim", "--udp", f"127.0.0.1:{daemon.suit_port}", "--seed", "1"], stdout=subprocess.DEVNULL)
        time.sleep(1.0)
        before, files = daemon.get("status"), open_files(daemon.process)
        stop = threading.Event()
        clients = [StuckClient(daemon, i, stop, arguments.seed) for i in range(arguments.clients)]
        for client in clients:
            client.start()
        asked, unanswered, longest_s = ask_as_usual(daemon, arguments.seconds)
        at_work = daemon.get("status")
        stop.set()
        for client in clients:
            client.join(30)
        end = time.monotonic() + 90
        while True:
            after = daemon.get("status")
            # The connection that asked is being closed meanwhile; what stays open stays to the end.
            left_open = open_files(daemon.process) - files
            if (after["clients"]["connections"] <= 1 and left_open <= 0) or time.monotonic() > end:
                break
            time.sleep(0.5)
        sim.kill()
        alive = daemon.process.poll() is None
        daemon.process.kill()
        log = daemon.log_path.read_text()
    rounds = sum(client.rounds for client in clients)
    dropped = after["rings"]["frames"]["dropped"] + after["suit"]["socket"]["kernel_drops"]
    growth = at_work["process"]["rss_bytes"] - before["process"]["rss_bytes"]
    print(f"{arguments.clients} clients, {rounds} connections: {asked} requests beside them, {unanswered} unanswered, the longest {longest_s * 1e3:.0f} ms")
    print(f"frames {after['suit']['stream']['frames']}, dropped {dropped}; {growth >> 20} MiB more at work; {left_open} files left open; tokens in the log: {log.count(TOKEN)}")
    print("clients: " + ", ".join(f"{name} {count}" for name, count in after["clients"].items()))
    faults = [
        text
        for text, is_fault in (
            ("the daemon has ended", not alive),
            ("a request was not answered", unanswered > 0),
            ("frames were dropped", dropped > 0),
            ("connections are left", after["clients"]["connections"] > 1),
            ("files are left open", left_open > 0),
            ("memory grew", growth > GROWTH_BYTES),
            # Who of those too many had to go, the newcomer or one that was there, is chance.
            ("nobody was kept out", sum(after["clients"][name] for name in ("gave_way", "refused", "displaced")) == 0),
            ("nonsense was not counted", after["clients"]["errors"] == 0),
            ("the token is in the log", TOKEN in log),
        )
        if is_fault
    ]
    print("; ".join(faults) or "all as it should be")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
