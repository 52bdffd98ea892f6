#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The suit comes and goes: faults of a suit's stream are put into a simulated recording, and the map is compared with the undisturbed one.

Objects lost and false must be 0, and sizes within 2 cm where the fault carries no information away (`whole`). Exit code 1 when a criterion fails.

usage: suit.py KINEMAP [--seeds N ...] [--only NAME ...]
"""
import argparse
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

SIZE_M = 0.02
NEAR_M = 0.5  # objects of one type this near are the same


class Packet:
    """A UDP packet of a capture as `kinemap sim` writes it: Ethernet, IPv4."""

    def __init__(self, time_s, data):
        self.time_s, self.data = time_s, bytearray(data)
        self.at = 14 + 4 * (data[14] & 15) + 8  # of the payload

    def copy(self):
        return Packet(self.time_s, self.data)

    @property
    def type(self):
        return bytes(self.data[self.at + 4 : self.at + 6])

    @property
    def counter(self):
        return struct.unpack_from(">I", self.data, self.at + 6)[0]

    @counter.setter
    def counter(self, value):
        struct.pack_into(">I", self.data, self.at + 6, value & 0xFFFFFFFF)

    @property
    def time_code(self):
        return struct.unpack_from(">I", self.data, self.at + 12)[0]

    @time_code.setter
    def time_code(self, value):
        struct.pack_into(">I", self.data, self.at + 12, value % 86400000)

    def segments(self):
        return range(self.at + 24, len(self.data) - 31, 32) if self.type == b"02" else ()

    def move(self, heading, shift):
        """Turns the body about the world's origin, then shifts it."""
        c, s = math.cos(heading), math.sin(heading)
        ch, sh = math.cos(heading / 2), math.sin(heading / 2)
        for at in self.segments():
            x, y, z, w, i, j, k = struct.unpack_from(">7f", self.data, at + 4)
            struct.pack_into(
                ">7f", self.data, at + 4,
                c * x - s * y + shift[0], s * x + c * y + shift[1], z + shift[2],
                ch * w - sh * k, ch * i - sh * j, ch * j + sh * i, ch * k + sh * w,
            )  # fmt: skip

    def scale(self, factor):
        for at in self.segments():
            struct.pack_into(">3f", self.data, at + 4, *(factor * v for v in struct.unpack_from(">3f", self.data, at + 4)))

    def pelvis(self):
        return struct.unpack_from(">3f", self.data, self.at + 28)


def read_pcap(path):
    data = path.read_bytes()
    unit = {0xA1B2C3D4: 1e-6, 0xA1B23C4D: 1e-9}[struct.unpack_from("<I", data)[0]]
    packets, at = [], 24
    while at < len(data):
        seconds, fraction, size, _ = struct.unpack_from("<IIII", data, at)
        packets.append(Packet(seconds + fraction * unit, data[at + 16 : at + 16 + size]))
        at += 16 + size
    return packets


def write_pcap(path, packets):
    with open(path, "wb") as out:
        out.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
        for p in packets:
            microseconds = round(p.time_s * 1e6)
            out.write(struct.pack("<IIII", microseconds // 1000000, microseconds % 1000000, len(p.data), len(p.data)) + p.data)


def after(packets, moment):
    """Packets before and from a moment (part of the session, 0–1)."""
    begin, end = packets[0].time_s, packets[-1].time_s
    return next(k for k, p in enumerate(packets) if p.type == b"02" and p.time_s >= begin + moment * (end - begin))


def waiting(packets, chance):
    """A moment in which the wearer stands and his right hand rests, as for a calibration."""

    def motion(k):
        hand = lambda p: struct.unpack_from(">3f", p.data, p.at + 24 + 10 * 32 + 4)
        return math.dist(hand(packets[k - 90]), hand(packets[k])) + math.dist(hand(packets[k]), hand(packets[k + 90]))

    poses = [k for k in range(200, len(packets) - 200) if all(packets[n].type == b"02" for n in (k - 90, k, k + 90))]
    return min((poses[int(chance.uniform(0.3, 0.8) * len(poses))] for _ in range(60)), key=motion)


def drawing(packets, chance):
    """A moment amid a gesture: the left hand has lain on its hip for 4 s, and will for 4 s more."""

    def on_hip(p):
        at = lambda segment: struct.unpack_from(">3f", p.data, p.at + 24 + (segment - 1) * 32 + 4)
        hand, hip = at(15), at(20)
        return hand[2] > hip[2] + 0.05 and math.dist(hand, hip) < 0.35

    poses = [k for k, p in enumerate(packets) if p.type == b"02"]
    since, runs = None, []
    for k in poses[::12]:
        if not on_hip(packets[k]):
            since = None
        elif since is None:
            since = k
        if since is not None and packets[k].time_s - packets[since].time_s > 8.0:
            runs.append(next(n for n in poses[poses.index(since) :] if packets[n].time_s >= packets[k].time_s - 4.0))
    return chance.choice(runs)


def moved_from(packets, k, heading, anew):
    """The suit's world is another one from packet k on: the pelvis at its origin, or (not anew) anywhere."""
    x, y, z = packets[k].pelvis()
    c, s = math.cos(heading), math.sin(heading)
    shift = (-(c * x - s * y), -(s * x + c * y), 0.0) if anew else (7.0, -4.0, 0.3)
    for p in packets[k:]:
        p.move(heading, shift)
    return packets


# Each fault takes the packets (its own copy) and a source of random numbers, and gives what arrives.
def reorder(packets, chance):
    for p in packets:
        if chance.random() < 0.2:
            p.time_s += chance.uniform(0.0, 0.03)
    return sorted(packets, key=lambda p: p.time_s)


def duplicates(packets, chance):
    twins = [p.copy() for p in packets if chance.random() < 0.3]
    for p in twins:
        p.time_s += chance.uniform(0.0, 0.2)
    return sorted(packets + twins, key=lambda p: p.time_s)


def loss(packets, chance):
    kept, losing = [], False
    for p in packets:  # bursts of 12 samples on average
        losing = chance.random() < (1 - 1 / 12 if losing else 0.3 / 0.7 / 12)
        if not losing:
            kept.append(p)
    return kept


def long_losses(packets, chance):
    """A third is lost in bursts of a third of a second, amid gestures too."""
    kept, lost_until = [], 0.0
    for p in packets:
        if p.time_s > lost_until + 2 / 3:
            lost_until = p.time_s + chance.uniform(0.2, 0.45)
        if p.time_s >= lost_until:
            kept.append(p)
    return kept


def clock_back(packets, chance):
    """The suit's clock is set back by an hour; its counter goes on."""
    for p in packets[after(packets, chance.uniform(0.3, 0.8)) :]:
        p.time_code -= 3600000
    return packets


def rate_change(packets, chance):
    """MVN streams at half the rate at first, then at the whole."""
    k, kept, counter = after(packets, chance.uniform(0.3, 0.7)), [], 0
    for n, p in enumerate(packets):
        if p.type != b"02":
            kept.append(p)
        elif n >= k or p.counter % 2 == 0:
            p.counter = counter = counter + 1
            kept.append(p)
    return kept


def fewer_segments(packets, chance):
    """For half a second now and then the sender leaves out the last three segments."""
    begins = [packets[0].time_s + t for t in range(5, 1000, 20)]
    for p in packets:
        if p.type == b"02" and any(t <= p.time_s < t + 0.5 for t in begins):
            del p.data[len(p.data) - 3 * 32 :]
            p.data[p.at + 11] = p.data[p.at + 17] = 20
            for at, size in ((16, len(p.data) - 14), (p.at - 4, len(p.data) - p.at + 8), (p.at + 22, len(p.data) - p.at - 24)):
                struct.pack_into(">H", p.data, at, size)
    return packets


def reset(packets, chance):
    return moved_from(packets, after(packets, chance.uniform(0.3, 0.8)), chance.uniform(-3, 3), False)


def three_resets(packets, chance):
    for moment in sorted(chance.uniform(0.2, 0.9) for _ in range(3)):
        packets = moved_from(packets, after(packets, moment), chance.uniform(-3, 3), chance.random() < 0.5)
    return packets


def restart(packets, chance, k=None, silence_s=1.5):
    """MVN is started anew while the wearer waits: counter, time code and world begin anew."""
    k = waiting(packets, chance) if k is None else k
    packets = moved_from(packets, k, chance.uniform(-3, 3), True)
    counter = packets[k].counter
    for p in packets[k:]:
        p.counter -= counter
        p.time_code += 5000000
        p.time_s += silence_s
    return packets


def restart_amid_gesture(packets, chance):
    """The wearer waits for MVN, hand on the wall."""
    return restart(packets, chance, drawing(packets, chance))


def restart_while_drawing(packets, chance):
    """The wearer does not wait: 1.5 s of the gesture are lost."""
    k = drawing(packets, chance)
    begin = packets[k].time_s
    tail = [p for p in packets[k:] if p.time_s >= begin + 1.5]
    return packets[:k] + restart(tail, chance, after(tail, 0.0), 0.0)


def long_restart(packets, chance):
    """MVN is started anew, and the wearer does not wait: half a minute of what he does is lost as well."""
    k = after(packets, chance.uniform(0.4, 0.6))
    begin = packets[k].time_s
    tail = [p for p in packets[k:] if p.time_s >= begin + 30.0]
    return packets[:k] + restart(tail, chance, after(tail, 0.0), 0.0)


def silence(packets, chance, length_s=2.0):
    k = after(packets, chance.uniform(0.3, 0.8))
    return [p for p in packets if not packets[k].time_s <= p.time_s < packets[k].time_s + length_s]


def pause(packets, chance, length_s=120):
    """The sender holds, counter and all, while the wearer stands; then it goes on."""
    k = after(packets, chance.uniform(0.3, 0.8))
    for p in packets[k:]:
        p.time_s += length_s
        p.time_code += 1000 * length_s
    return packets


def hour_pause(packets, chance):
    return pause(packets, chance, 3600)


def other_sender(packets, chance, character=0):
    """Another suit at the same port, of another wearer elsewhere, from its own address."""
    strange = [p.copy() for p in packets[2000:]]
    first, offset = strange[0].time_s, packets[0].time_s + 20.0
    for p in strange:
        p.time_s += offset - first
        p.move(1.0, (5.0, 5.0, 0.0))
        p.data[29] ^= 0x01  # last byte of the source address
        p.data[p.at + 16] = character
    return sorted(packets + [p for p in strange if p.time_s < packets[-1].time_s], key=lambda p: p.time_s)


def other_character(packets, chance):
    return other_sender(packets, chance, character=1)


FAULTS = {
    # name: (fault, whether nothing of what the map is made of is lost, rounds of the session; None: as the seed has it)
    "reorder": (reorder, True, None),
    "duplicates": (duplicates, True, None),
    "loss": (loss, False, None),
    "silence": (silence, False, None),
    "pause": (pause, True, None),
    "hour_pause": (hour_pause, True, None),
    "long_losses": (long_losses, False, None),
    "clock_back": (clock_back, True, None),
    "rate_change": (rate_change, False, None),
    "fewer_segments": (fewer_segments, False, None),
    "reset": (reset, True, None),
    "three_resets": (three_resets, True, None),
    "restart": (restart, True, None),
    "restart_amid_gesture": (restart_amid_gesture, False, None),
    "restart_while_drawing": (restart_while_drawing, False, None),
    "long_restart": (long_restart, False, 6),  # the wearer comes by enough of what is known for the parts to be joined
    "other_sender": (other_sender, True, None),
    "other_character": (other_character, True, None),
}


def build(kinemap, recording, out):
    subprocess.run([kinemap, "build", str(recording), "--out", str(out)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((out / "map.json").read_text())["objects"]


def middle(o):
    corners = o.get("corners")
    return [sum(c[i] for c in corners) / 4 for i in range(3)] if corners else o["pose"]["position"]


def compare(clean, map_):
    """Lost and false objects, the largest difference of a size, the largest of a place; m."""
    left, lost, size, place = list(map_), [], 0.0, 0.0
    for o in clean:
        near = [(math.dist(middle(o), middle(x)), n) for n, x in enumerate(left) if x["type"] == o["type"]]
        if not near or min(near)[0] > NEAR_M:
            lost.append(f"{o['type']} {o['id']}")
            continue
        distance, n = min(near)
        twin = left.pop(n)
        place = max(place, distance)
        for a, b in zip(o.get("size", []), twin.get("size", [])):
            size = max(size, abs(a - b))
    return lost, [f"{o['type']} {o['id']}" for o in left], size, place


class Session:
    """An undisturbed session and its map."""

    def __init__(self, kinemap, folder, seed, rounds):
        folder.mkdir()
        longer = ["--rounds", str(rounds)] if rounds else []
        simulate = ["sim", "--seed", str(seed), "--rooms", "1", "--drift", "good", "--packet-loss", "0", *longer, "--out", str(folder)]
        subprocess.run([kinemap, *simulate], check=True, stdout=subprocess.DEVNULL)
        self.packets = read_pcap(folder / "session.pcap")
        self.map = build(kinemap, folder / "session.pcap", folder / "clean")
        length = self.packets[-1].time_s - self.packets[0].time_s
        print(f"seed {seed}: {len(self.map)} objects, {length:.0f} s", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("kinemap")
    parser.add_argument("--seeds", type=int, nargs="+", default=[3])
    parser.add_argument("--only", choices=FAULTS, nargs="+", default=list(FAULTS))
    arguments = parser.parse_args()
    failures = 0
    for seed in arguments.seeds:
        with tempfile.TemporaryDirectory() as name:
            folder, sessions = pathlib.Path(name), {}
            for fault in arguments.only:
                apply, whole, rounds = FAULTS[fault]
                if rounds not in sessions:
                    sessions[rounds] = Session(arguments.kinemap, folder / f"session{rounds}", seed, rounds)
                session = sessions[rounds]
                write_pcap(folder / "disturbed.pcap", apply([p.copy() for p in session.packets], random.Random(f"{seed} {fault}")))
                map_ = build(arguments.kinemap, folder / "disturbed.pcap", folder / fault)
                lost, false, size, place = compare(session.map, map_)
                wrong = bool(lost or false or (whole and size > SIZE_M))
                failures += wrong
                print(
                    f"  {fault}: {len(lost)} lost, {len(false)} false, sizes within {100 * size:.1f} cm, places within {100 * place:.1f} cm"
                    + (f"   WRONG: lost {lost}, false {false}" if wrong else ""),
                    flush=True,
                )
    print(f"{failures} of the maps are wrong" if failures else "all maps are right")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
