# SPDX-License-Identifier: Apache-2.0
"""check_hardening.py PROGRAM SOURCE_DIR: whether an ELF program is what cmake/Kinemap.cmake asks of the compiler and linker, and names no file
of the machine that it was built on. check_hardening.py --self-test COMPILER: whether a program without all that is found out."""

import pathlib
import subprocess
import sys
import tempfile


def readelf(program: str, what: str) -> str:
    return subprocess.run(["readelf", "--wide", what, program], check=True, capture_output=True, text=True).stdout


def calls_of_ours(program: str) -> set[str]:
    """What our own functions call; libraries that are linked in may be hardened without us."""
    calls, ours = set(), False
    code = ["objdump", "--disassemble", "--no-show-raw-insn", "--section=.text", program]
    with subprocess.Popen(code, stdout=subprocess.PIPE, text=True) as listing:
        for line in listing.stdout:
            if line.endswith(">:\n"):
                ours = "7kinemap" in line or "<main>" in line
            elif ours and "@plt>" in line:
                calls.add(line[line.rindex("<") + 1 : line.rindex("@plt>")])
    return calls


def flaws(program: str, source_dir: str) -> list[str]:
    dynamic = readelf(program, "--dynamic")
    segments = readelf(program, "--segments")
    calls = calls_of_ours(program)
    stack = next((line.split() for line in segments.splitlines() if "GNU_STACK" in line), [])
    wanted = {
        "no position-independent executable (-fPIE -pie)": "PIE" in dynamic and "DYN" in readelf(program, "--file-header"),
        "no relocation read-only (-z relro)": "GNU_RELRO" in segments,
        "bound lazily (-z now)": "BIND_NOW" in dynamic and " NOW" in dynamic,
        "no stack protector (-fstack-protector-strong)": "__stack_chk_fail" in calls,
        "no fortified call (-D_FORTIFY_SOURCE=2)": any(call.endswith("_chk") for call in calls),
        "an executable stack": "RW" in stack,
        f"names a file in {source_dir} (-ffile-prefix-map)": source_dir.encode() not in pathlib.Path(program).read_bytes(),
    }
    return [flaw for flaw, is_right in wanted.items() if not is_right]


def self_test(compiler: str) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder, "weak.cpp")
        source.write_text("#include <cstdio>\nint main() { std::puts(__FILE__); }\n", encoding="utf-8")
        program = str(source.with_suffix(""))
        options = "-O1 -U_FORTIFY_SOURCE -fno-stack-protector -fno-pie -no-pie -Wl,-z,norelro,-z,lazy,-z,execstack".split()
        subprocess.run([compiler, *options, "-o", program, str(source)], check=True, stderr=subprocess.DEVNULL)
        found = flaws(program, folder)
    return [] if len(found) == 7 else [f"only these of seven flaws were found: {found}"]


def main() -> int:
    bad = self_test(sys.argv[2]) if sys.argv[1] == "--self-test" else flaws(sys.argv[1], sys.argv[2])
    for flaw in bad:
        print(f"{sys.argv[1]}: {flaw}", file=sys.stderr)
    return int(bool(bad))


sys.exit(main())
