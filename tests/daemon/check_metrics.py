#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Has promtool (Debian: prometheus) read what /metrics serves; exits with 77, which ctest counts as skipped, where there is none.

Usage: check_metrics.py METRICS.txt    (written by metrics_test)
"""
import shutil
import subprocess
import sys

if not shutil.which("promtool"):
    print("SKIPPED: promtool is missing (Debian package prometheus, whose server you may want to disable)")
    sys.exit(77)
with open(sys.argv[1], "rb") as file:
    text = file.read()
# Its lint's remarks are failures too: it prints nothing where all is well.
checked = subprocess.run(["promtool", "check", "metrics"], input=text, capture_output=True, check=False)
print((checked.stdout + checked.stderr).decode() or f"{text.count(b'# TYPE')} families, nothing to remark")
if checked.returncode != 0 or checked.stdout or checked.stderr:
    sys.exit(1)
# And it does notice what is wrong.
if subprocess.run(["promtool", "check", "metrics"], input=text + b"kinemap_x{ 1\n", capture_output=True, check=False).returncode == 0:
    sys.exit("promtool takes a spoilt text")
