#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What soak.py takes for a leak, and what not."""
import contextlib
import io
import random
import unittest

import soak


def day(rss_mb=lambda hours: 80.0, handles=lambda hours: 20, dropped=0):
    """Four hours of samples as soak.py takes them at 20 times real time; handles flicker by one, as a checkpoint makes them, and memory by the solver's."""
    chance = random.Random(5)
    samples = []
    for i in range(76):
        hours = i / 18.0
        samples.append({
            "solved_s": 3600.0 * hours, "dropped": dropped, "landmarks": 12,
            "rss_mb": rss_mb(hours) + chance.uniform(0.0, 10.0), "handles": handles(hours) + chance.randrange(2),
        })
    return samples


def problems(**how):
    with contextlib.redirect_stdout(io.StringIO()):
        return soak.judge(day(**how))


class Judge(unittest.TestCase):
    def test_a_flat_day_is_well(self):
        self.assertEqual(problems(), [])

    def test_one_handle_an_hour_is_a_leak(self):
        self.assertRegex(str(problems(handles=lambda hours: 20 + int(hours))), "file handles grew from 21 to 2[34]")

    def test_one_handle_in_the_whole_day_is_a_leak(self):
        self.assertRegex(str(problems(handles=lambda hours: 20 + (hours > 2.5))), "file handles grew from 20 to 21")

    def test_memory_may_grow_by_five_percent_an_hour(self):
        self.assertEqual(problems(rss_mb=lambda hours: 80.0 + 2.0 * hours), [])
        self.assertRegex(str(problems(rss_mb=lambda hours: 80.0 + 6.0 * hours)), "memory grows by [67]")

    def test_what_happens_in_the_first_hour_does_not_count(self):
        self.assertEqual(problems(rss_mb=lambda hours: 80.0 * min(1.0, hours), handles=lambda hours: 20 - 3 * (hours < 0.9)), [])

    def test_drops_count(self):
        self.assertEqual(problems(dropped=3), ["3 frames or datagrams were dropped"])


if __name__ == "__main__":
    unittest.main()
