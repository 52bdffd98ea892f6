#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks who includes whom: core ← protocol ← daemon ← tools, never the other way; core knows no thread, socket, file, clock or JSON;
the simulator (tools/sim) reaches nothing of core, through no chain of includes.

Usage: check_layers.py ROOT        checks the repository
       check_layers.py --self-test checks that each rule can fail
"""
import pathlib
import re
import sys
import tempfile

LAYERS = ["core", "protocol", "daemon", "tools"]

# What core must not include: time, threads, files, sockets, streams for output, other people's I/O.
FORBIDDEN_IN_CORE = re.compile(
    r"^(chrono|ctime|time\.h|thread|mutex|shared_mutex|condition_variable|future|stop_token|semaphore|latch|barrier"
    r"|fstream|iostream|cstdio|stdio\.h|filesystem|unistd\.h|fcntl\.h|sys/.*|netinet/.*|arpa/.*|netdb\.h"
    r"|boost/.*|nlohmann/.*|spdlog/.*|fmt/.*|expat\.h|CLI/.*|systemd/.*)$")
# Only these may know Ceres.
CERES_HOMES = "core/graph/"

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def includes_of(root):
    """path → names included, for every source of the four layers."""
    found = {}
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h"):
                text = path.read_text(encoding="utf-8")
                found[path.relative_to(root).as_posix()] = [match.group(2) for match in INCLUDE.finditer(text)]
    return found


def layer_of(name):
    first = name.split("/")[0]
    return LAYERS.index(first) if first in LAYERS else None


def reachable(start, includes):
    seen, waiting = {}, [(start, start)]
    while waiting:
        name, chain = waiting.pop()
        if name in seen:
            continue
        seen[name] = chain
        waiting += [(other, f"{chain} → {other}") for other in includes.get(name, [])]
    return seen


def problems(root):
    includes = includes_of(root)
    for path, names in includes.items():
        for name in names:
            if layer_of(name) is not None and layer_of(name) > layer_of(path):
                yield f"{path} includes {name}: dependencies point the other way"
            if path.startswith("core/") and FORBIDDEN_IN_CORE.match(name):
                yield f"{path} includes <{name}>: core knows no thread, socket, file, clock or JSON"
            if name.startswith("ceres/") and not path.startswith(CERES_HOMES):
                yield f"{path} includes <{name}>: Ceres stays in {CERES_HOMES}"
            if name.startswith("ceres/") and path.endswith(".hpp") and "residual" not in path and "cost" not in path:
                yield f"{path} includes <{name}>: Ceres stays out of widely included headers"
            if path.startswith("protocol/wire/") and name.startswith(("core/", "protocol/")) and not name.startswith("protocol/wire/"):
                yield f"{path} includes {name}: wire is bytes only"
        if path.startswith("tools/sim/"):
            for name, chain in reachable(path, includes).items():
                if name.startswith("core/"):
                    yield f"the simulator reaches the estimator: {chain}"
    if not includes:
        yield f"{root}: no sources found"


SPOILT = {
    "core knows the protocol": {"core/a.hpp": '#include "protocol/b.hpp"\n'},
    "core reads a clock": {"core/a.cpp": "#include <chrono>\n"},
    "core writes": {"core/deep/er/a.cpp": "  #  include <iostream>\n"},
    "core makes threads": {"core/a.cpp": "#include <thread>\n"},
    "core knows JSON": {"core/a.hpp": "#include <nlohmann/json_fwd.hpp>\n"},
    "protocol knows the daemon": {"protocol/a.cpp": '#include "daemon/b.hpp"\n'},
    "the daemon knows the tools": {"daemon/a.cpp": '#include "tools/b.hpp"\n'},
    "wire knows core": {"protocol/wire/a.hpp": '#include "core/pose.hpp"\n'},
    "Ceres leaks": {"core/mapper/a.cpp": "#include <ceres/ceres.h>\n"},
    "the simulator shares code": {
        "tools/sim/a.cpp": '#include "protocol/b.hpp"\n',
        "protocol/b.hpp": '#include "core/pose.hpp"\n',
        "core/pose.hpp": "#include <cmath>\n",
    },
}


def self_test():
    failures = 0
    for what, files in SPOILT.items():
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, encoding="utf-8")
            if not list(problems(root)):
                print(f"not noticed: {what}")
                failures += 1
    print(f"{len(SPOILT)} spoilt trees, {failures} not noticed")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 1 if self_test() else 0
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "the layers are in order")
    return 1 if found else 0


sys.exit(main())
