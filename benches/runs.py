#!/usr/bin/env python3
"""Whole runs: processor time and peak memory of `armwright run`, and of a second program beside it if one is given.

    cargo build --release
    python3 benches/runs.py target/release/armwright [OTHER] [--only NAME,...] [--times N]

Each line is a run with one thread: seconds of processor time (the least of N, pages and plots included), peak resident
memory, and designs on the front. With OTHER both programs run in turn, so that a machine that slows down slows both; the
ratio is OTHER's time over ours, and `same` says whether both wrote the same bytes into front.csv.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def study(name, change=lambda study: None):
    text = json.loads((ROOT / f"studies/{name}.json").read_text())
    change(text)
    return text


def slope_k1(study):
    study["models"] = {**study.get("models", {}), "joints": "three_segment_k1"}


def too_dear(study):
    study["constraints"] = {"material_cost_max_eur": 0.1}


# name, study, words after `run STUDY`
RUNS = [
    ("stiff-arm", study("stiff-arm"), []),
    ("light-arm", study("light-arm"), []),
    ("compare-materials", study("compare-materials"), []),
    ("light-arm, exact", study("light-arm"), ["--search", "exact"]),
    ("no design", study("stiff-arm", too_dear), []),
    ("full-catalog to 2 %", study("full-catalog"), ["--gap", "2%"]),
    ("with the slope K1", study("full-catalog", slope_k1), ["--gap", "2%"]),
]


def run(exe, text, words, out):
    """Processor seconds, peak megabytes and front.csv of a run."""
    file = out / "study.json"
    file.write_text(json.dumps(text))
    args = [exe, "-q", "run", str(file), "--threads", "1", "--out", str(out / "results"), *words]
    with subprocess.Popen(args, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, _, used = os.wait4(process.pid, 0)
    front = out / "results/front.csv"
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, front.read_bytes() if front.exists() else b""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exe")
    parser.add_argument("other", nargs="?")
    parser.add_argument("--only", help="names of runs, separated by semicolons")
    parser.add_argument("--times", type=int, default=1)
    options = parser.parse_args()
    exes = [os.path.abspath(exe) for exe in (options.exe, options.other) if exe]
    print(f"{'run':<22}{'s':>9}{'MB':>7}{'front':>8}" + ("   other s     MB  ratio  same" if options.other else ""))
    for name, text, words in RUNS:
        if options.only and name not in options.only.split(";"):
            continue
        best = [(float("inf"), 0.0, b"")] * len(exes)
        for _ in range(options.times):
            for k, exe in enumerate(exes):
                with tempfile.TemporaryDirectory() as out:
                    best[k] = min(best[k], run(exe, text, words, Path(out)), key=lambda run: run[0])
        (seconds, megabytes, front), *other = best
        line = f"{name:<22}{seconds:>9.2f}{megabytes:>7.0f}{max(front.count(bytes([10])) - 1, 0):>8}"
        for its_s, its_mb, its_front in other:
            same = "yes" if its_front == front else "NO"
            line += f"{its_s:>10.2f}{its_mb:>7.0f}{its_s / seconds:>7.2f}{same:>6}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
