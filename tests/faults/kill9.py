#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""kinemapd is killed (SIGKILL) at random moments of a session and started again, over and over.

After each restart every object that the killed daemon had announced must be there again, at its place, and the way up to the last second. Between
death and the next start the suit is held. In every other session it is held just before the kill as well, so that nothing of its stream is missed:
these sessions must end in the map of the undisturbed one, to 2 cm. In the others the daemon dies amid the stream, and what was on its way is lost.

usage: kill9.py KINEMAPD KINEMAP --kills N [--speed S] [--seed SEED]
"""
import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from kinemapd import PLACE_M, Daemon, Suit, datagrams, moved


def missing(announced, restored):
    """Objects of the first map that are not in the second, or elsewhere. The second may know more: what was on the disk and not announced yet. That
    may have moved things, so places are compared where both are of the same revision; or shown that two objects are one, which then has the visits of both."""
    same = announced["revision"] == restored["revision"]
    if restored["revision"] < announced["revision"]:
        return [f"revision {announced['revision']} was announced, {restored['revision']} is back"]
    there = {o["id"]: o for o in restored["objects"]}
    visited = [(o["type"], visit) for o in restored["objects"] for visit in o["visits"]]
    lost = []
    for o in announced["objects"]:
        twin = there.get(o["id"])
        if twin is None and not same and all((o["type"], visit) in visited for visit in o["visits"]):
            continue
        if twin is None or twin["type"] != o["type"]:
            lost.append(f"{o['type']} {o['id']} is gone")
        elif same and max(abs(a - b) for a, b in zip(o["pose"]["position"], twin["pose"]["position"])) > PLACE_M:
            lost.append(f"{o['type']} {o['id']} moved")
    return lost


def hold(suit, daemon):
    """The suit pauses, and the daemon takes what was on its way and writes it down."""
    suit.running.clear()
    before, taken = None, daemon.pose_time()
    while taken != before or daemon.get("status")["journal"]["waiting_entries"] > 0:
        time.sleep(0.03)
        before, taken = taken, daemon.pose_time()


def written_s(kinemap, state):
    """How far the journal on the disk reaches, stream time: its entries are in the order of what happened."""
    sessions = list((state / "sessions").glob("*"))
    if not sessions:
        return 0.0
    show = [kinemap, "sessions", "show", sessions[0].name, "--directory", str(state), "--json"]
    return json.loads(subprocess.run(show, check=True, capture_output=True).stdout)["duration_s"]


def way_lost_s(undisturbed, written, seen):
    """From the first to the last key pose of the undisturbed session that had been seen and was not written. (The map that is served tells of key
    poses some at a time, and who stands still makes none: neither says what was lost.)"""
    lost = [t for t in undisturbed if written < t <= seen]
    return lost[-1] - lost[0] if lost else 0.0


def run_session(arguments, recording, config, state, kills, held, key_poses, log):
    """One session with so many kills in it: its map and the times of its key poses. A line of figures for each kill; `key_poses`: undisturbed."""
    length = recording[-1][0] - recording[0][0]
    suit = Suit(recording, arguments.speed)
    moments = sorted(log.random.uniform(2.0, length) for _ in range(kills))
    daemon = Daemon(arguments.kinemapd, config)
    suit.port = daemon.suit_port
    for moment in moments:
        suit.running.set()
        announced = daemon.get("map")
        while suit.sent_s < moment and not suit.ended:
            time.sleep(0.01)
            announced = daemon.get("map")
        if held:
            hold(suit, daemon)
            time.sleep(log.random.uniform(0.0, 0.05))
        seen_s = daemon.pose_time()
        suit.running.clear()
        daemon.kill()
        lost_s = way_lost_s(key_poses, written_s(arguments.kinemap, state), seen_s) / arguments.speed
        died = daemon
        daemon = Daemon(arguments.kinemapd, config)
        suit.port = daemon.suit_port
        restored, _ = daemon.restored()
        log.add(moment, missing(announced, restored), lost_s, len(announced["objects"]), "".join(died.log[-20:]))
    suit.running.set()
    while not suit.ended:
        time.sleep(0.05)
    daemon.settle()
    final, poses = daemon.get("map"), daemon.get("trajectory")["poses"]
    daemon.kill()
    return final, [p["time"] for p in poses]


class Log:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.kills, self.lost, self.longest_s = 0, 0, 0.0

    def add(self, moment, lost, lost_s, objects, log):
        self.kills += 1
        self.lost += len(lost)
        self.longest_s = max(self.longest_s, lost_s)
        print(f"kill {self.kills}: at {moment:.1f} s, {objects} objects announced, {len(lost)} lost, {lost_s:.2f} s of key poses lost", flush=True)
        if lost:
            print("  " + "; ".join(lost) + "\n" + log)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemapd")
    parser.add_argument("kinemap")
    parser.add_argument("--kills", type=int, default=8)
    parser.add_argument("--per-session", type=int, default=8)
    parser.add_argument("--speed", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=3)
    arguments = parser.parse_args()
    log = Log(arguments.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([arguments.kinemap, "sim", "--seed", str(arguments.seed), "--drift", "good", "--out", name], check=True, stdout=subprocess.DEVNULL)
        recording = list(datagrams(folder / "session.pcap"))
        session, missed = 0, {True: [], False: []}
        undisturbed, key_poses = None, []
        while log.kills < arguments.kills:
            config = folder / f"config{session}.json"
            state = folder / f"state{session}"
            config.write_text(json.dumps({"journal": {"directory": str(state), "min_free_mb": 0}}))
            kills = min(arguments.per_session, arguments.kills - log.kills) if undisturbed else 0
            held = session % 2 == 1
            final, times = run_session(arguments, recording, config, state, kills, held, key_poses, log)
            undisturbed, key_poses = undisturbed or final, key_poses or times
            others, farthest = moved(undisturbed, final)
            if session:
                missed[held].append(bool(others))
            how = "held" if held else "amid the stream" if session else "undisturbed"
            print(f"session {session}, {how}: {len(final['objects'])} objects in the end; {', '.join(others) or 'the undisturbed map'}, to {1000 * farthest:.1f} mm", flush=True)
            session += 1
    print(f"{log.kills} kills: {log.lost} announced objects lost, at most {log.longest_s:.2f} s of key poses")
    for held, others in missed.items():
        print(f"{'suit held' if held else 'amid the stream'}: {others.count(False)} of {len(others)} maps are the undisturbed one")
    sys.exit(1 if log.lost or log.longest_s > 1.0 or any(missed[True]) else 0)


if __name__ == "__main__":
    main()
