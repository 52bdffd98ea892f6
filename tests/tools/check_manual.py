#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The manual pages and the completion, held against what the programs say with --help.

Usage: check_manual.py man|completion KINEMAP KINEMAPD KINEMAPD.8      77: groff or man is not here
"""
import pathlib
import re
import shutil
import subprocess
import sys

what, kinemap, kinemapd, page8 = sys.argv[1:5]


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def options_of(help_text):
    """The options in the left column of --help."""
    return {name for line in help_text.splitlines() if re.match(r"\s+-", line)
            for name in re.findall(r"(?<![\w-])--?[a-z][\w-]*", re.split(r"\s{2,}", line.strip())[0])}


commands = re.findall(r"^  (\w+) {2,}", said(kinemap, "--help").split("Subcommands:")[1].split("\n\n")[0], re.MULTILINE)
assert {"sim", "build", "map", "objects", "export", "watch", "status"} <= set(commands), commands
help_of = {command: said(kinemap, command, "--help") for command in commands}


def check_page(roff, name):
    run = subprocess.run(["groff", "-k", "-man", "-Tutf8", "-ww", "-rLL=100n"], input=roff.encode(), check=True, capture_output=True)
    assert not run.stderr, f"{name}: {run.stderr.decode()}"
    return re.sub(r"\x1b\[[\d;]*m|.\x08", "", run.stdout.decode()).replace("\u2010", "-")


def check_man():
    if not shutil.which("groff"):
        print("SKIPPED: groff is not here; tools/setup.sh --tests gets it")
        sys.exit(77)
    page = check_page(said(kinemap, "man"), "kinemap.1")
    parts = {name: text for name, text in re.findall(r"^   kinemap (\w+)[^\n]*\n(.*?)(?=^   kinemap |^[A-Z])", page, re.MULTILINE | re.DOTALL)}
    assert list(parts) == commands, f"{list(parts)} are not {commands}"
    for command in commands:
        for option in options_of(help_of[command]) - {"-h", "--help"}:
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", parts[command]), f"kinemap.1: {command} lacks {option}"
    page = check_page(pathlib.Path(page8).read_text(), "kinemapd.8")
    described = set(re.findall(r"^       (--?[\w-]+(?:, --[\w-]+)?)", page, re.MULTILINE))
    described = {option for line in described for option in line.split(", ")}
    real = options_of(said(kinemapd, "--help"))
    assert described == real, f"kinemapd.8 describes {described}, the program has {real}"
    print(f"{len(commands)} commands and {len(real)} options of kinemapd are in the pages")


def complete(*words):
    """What bash offers for the last of the words."""
    script = said(kinemap, "completion", "bash")
    quoted = " ".join(f"'{word}'" for word in words)
    body = f"{script}\nCOMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _kinemap; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    return set(said("bash", "-c", body).split())


def check_completion():
    assert complete("kinemap", "") == {*commands, "--help", "--version"}
    assert complete("kinemap", "st") == {"status"}
    for command in commands:
        offered = complete("kinemap", command, "--")
        wanted = {option for option in options_of(help_of[command]) if option.startswith("--")}
        assert offered == wanted, f"{command}: {offered ^ wanted}"
    assert complete("kinemap", "sim", "--drift", "") == {"good", "default", "bad"}
    assert complete("kinemap", "export", "plan") == {"plan.svg"}
    assert complete("kinemap", "build", "--out", "/us") == {"/usr"}
    assert complete("kinemap", "map", "--file", page8[:-2]) == {page8}
    assert complete("kinemap", "sim", "--seed", "") == set()
    for shell in ("zsh", "fish"):
        script = said(kinemap, "completion", shell)
        for command in commands:
            assert command in script
        if shutil.which(shell):
            subprocess.run([shell, "-n"], input=script, check=True, text=True)
    print(f"{len(commands)} commands are completed")


check_man() if what == "man" else check_completion()
