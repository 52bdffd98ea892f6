#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""kinemapd records the suit (journal.record) in several files, in one session; what `kinemap build` makes of them is the map that the daemon served, to the last
digit, but for the revision, which counts publications.

usage: rebuild.py KINEMAPD KINEMAP [--speed S] [--seed SEED]
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

from kinemapd import Daemon, Suit, datagrams


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemapd")
    parser.add_argument("kinemap")
    parser.add_argument("--speed", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        sim = [arguments.kinemap, "sim", "--seed", str(arguments.seed), "--rooms", "1", "--rounds", "1", "--out", name]
        subprocess.run(sim, check=True, stdout=subprocess.DEVNULL)
        recording = list(datagrams(folder / "session.pcap"))
        config = folder / "config.json"
        config.write_text(json.dumps({"journal": {"directory": str(folder / "state"), "min_free_mb": 0, "record": True, "record_file_mb": 2}}))
        daemon = Daemon(arguments.kinemapd, config)
        suit = Suit(recording, arguments.speed)
        suit.port = daemon.suit_port
        suit.running.set()
        while not suit.ended:
            time.sleep(0.05)
        daemon.settle()
        live, recorded = daemon.get("map"), daemon.get("status")["recording"]
        daemon.process.terminate()
        daemon.process.wait()
        session = next((folder / "state" / "sessions").iterdir())
        built = subprocess.run([arguments.kinemap, "build", str(session), "--out", str(folder / "map")], capture_output=True, text=True, check=True)
        rebuilt = json.loads((folder / "map" / "map.json").read_text())
    print(f"{recorded['datagrams']} datagrams in {recorded['files']} files, {recorded['dropped']} dropped; {len(live['objects'])} objects live, {len(rebuilt['objects'])} rebuilt")
    del live["revision"], rebuilt["revision"], live["run"]  # a run of the daemon
    wrong = [key for key in live if live[key] != rebuilt.get(key)]
    for key in wrong:
        print(f"{key} differs: {str(live[key])[:300]}\n  rebuilt: {str(rebuilt.get(key))[:300]}\n{built.stderr}")
    sys.exit(1 if wrong or recorded["files"] < 3 or recorded["dropped"] or recorded["datagrams"] != len(recording) else 0)


if __name__ == "__main__":
    main()
