#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The disk of kinemapd's journal (a small tmpfs) is filled up at random moments of a session and has room again later, over and over.

While it is full the mapping goes on, and status and log say what is wrong; with room again everything is written, nothing is missing. The map in the end is that
of an undisturbed session, and so is the one that comes back after a SIGKILL.

usage: full_disk.py KINEMAPD KINEMAP --times N [--speed S] [--seed SEED]      77: no tmpfs can be mounted here
"""
import argparse
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

from kinemapd import Daemon, Suit, datagrams, moved


class Disk:
    """A tmpfs of 4 MiB."""

    def __init__(self, place):
        self.place = place
        place.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(place)], capture_output=True).returncode != 0:
            print("SKIPPED: a tmpfs cannot be mounted here (root is needed): what a full disk does was NOT tested")
            sys.exit(77)

    def fill(self):
        with open(self.place / "filler", "ab", buffering=0) as file:
            for size in (65536, 1024, 1):
                try:
                    while True:
                        file.write(b"x" * size)
                except OSError:
                    pass

    def free(self):
        (self.place / "filler").unlink()

    def unmount(self):
        subprocess.run(["umount", "-l", str(self.place)], check=False)


def wait_for(what, holds):
    end = time.monotonic() + 30
    while time.monotonic() < end:
        if holds():
            return []
        time.sleep(0.02)
    return [f"not within 30 s: {what}"]


def session(arguments, recording, folder, directory, moments=(), disk=None):
    """(map in the end, map after a kill and a restart, what went wrong)"""
    config = folder / f"{directory.name}.json"
    config.write_text(json.dumps({"journal": {"directory": str(directory), "min_free_mb": 0}}))
    daemon = Daemon(arguments.kinemapd, config)
    suit = Suit(recording, arguments.speed)
    suit.port = daemon.suit_port
    suit.running.set()
    wrong = []
    journal = lambda: daemon.get("status")["journal"]
    for begin, end in moments:
        wrong += wait_for(f"{begin:.0f} s of the session", lambda: suit.sent_s >= begin)
        disk.fill()
        wrong += wait_for("status says that the disk is full", lambda: not journal()["healthy"])
        poses = daemon.get("status")["tracker"]["key_poses"]
        wrong += wait_for("the time of room", lambda: suit.sent_s >= end)
        wrong += wait_for("mapping goes on", lambda: daemon.get("status")["map"]["key_poses"] > poses)
        waiting = journal()["waiting_bytes"]
        disk.free()
        wrong += wait_for("all is written", lambda: journal()["healthy"] and journal()["waiting_bytes"] == 0)
        print(f"full from {begin:.1f} to {end:.1f} s, {waiting} bytes waited, {journal()['lost_entries']} entries lost", flush=True)
        wrong += ["entries were lost"] if journal()["lost_entries"] else []
    while not suit.ended:
        time.sleep(0.05)
    daemon.settle()
    final = daemon.get("map")
    log = "".join(daemon.log)
    if log.count("cannot be written") != len(moments) or log.count("is written again, nothing is missing") != len(moments):
        wrong.append("the log does not tell of each full disk once:\n" + log)
    daemon.kill()
    daemon = Daemon(arguments.kinemapd, config)
    restored, _ = daemon.restored()
    daemon.kill()
    shutil.rmtree(directory)  # the next session needs the room
    return final, restored, wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemapd")
    parser.add_argument("kinemap")
    parser.add_argument("--times", type=int, default=4)
    parser.add_argument("--speed", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=5)
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    wrong, done, farthest = [], 0, 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        disk = Disk(folder / "disk")
        try:
            sim = [arguments.kinemap, "sim", "--seed", str(arguments.seed), "--rooms", "1", "--rounds", "1", "--packet-loss", "0", "--out", name]
            subprocess.run(sim, check=True, stdout=subprocess.DEVNULL)
            recording = list(datagrams(folder / "session.pcap"))
            length = recording[-1][0] - recording[0][0]
            undisturbed, _, bad = session(arguments, recording, folder, folder / "undisturbed")
            wrong += bad
            while done < arguments.times:
                times = sorted(chance.uniform(2.0, length - 20.0) for _ in range(4))
                moments = [(a, min(a + chance.uniform(2.0, 15.0), b - 5.0)) for a, b in zip(times, times[1:] + [length]) if b - a > 10.0]
                final, restored, bad = session(arguments, recording, folder, disk.place / f"state{done}", moments, disk)
                wrong += bad
                done += len(moments)
                for map_ in (final, restored):
                    lost, distance = moved(undisturbed, map_)
                    wrong += lost
                    farthest = max(farthest, distance)
        finally:
            disk.unmount()
    print(f"{done} times full, {len(undisturbed['objects'])} objects, at most {1000 * farthest:.1f} mm off; {len(wrong)} wrong")
    for line in wrong:
        print("  " + line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
