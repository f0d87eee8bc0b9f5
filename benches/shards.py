#!/usr/bin/env python3
"""What it costs to split a run into shards: processor time, memory and files for 1, 4, 16 and 64 shards, and whether the
merged front has the bytes of the run in one piece.

cargo build --release; python3 benches/shards.py target/release/armwright [SHARDS...]

One thread, one shard after the other, so that the times add up."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from growth import study

SIDES = 36


def timed(command):
    """Processor seconds and peak megabytes of a command."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    errors = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{errors}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def megabytes(folder):
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()) / 1e6


def main():
    binary, counts = Path(sys.argv[1]).resolve(), [int(n) for n in sys.argv[2:]] or [1, 4, 16, 64]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        question = folder / "growth.json"
        question.write_text(json.dumps(study(joints=3, poses=3, sides=SIDES, walls=SIDES)))
        run = [binary, "run", question, "--search", "exhaustive", "--threads", "1", "--quiet"]
        whole_s, whole_mb = timed([*run, "--out", folder / "whole"])
        designs = json.loads((folder / "whole/run.json").read_text())["designs_evaluated"]
        print(f"{designs} designs; in one piece {whole_s:.1f} s, {whole_mb:.0f} MB")
        print("shards   all of them   longest       MB     merge       MB    files   same")
        for count in counts:
            parts = folder / f"parts-{count}"
            shard = lambda k: [*run, "--shard", f"{k}/{count}", "--out", parts / f"{k}-of-{count}"]
            times = [timed(shard(k)) for k in range(1, count + 1)]
            merge_s, merge_mb = timed([binary, "merge", parts, "--out", folder / f"merged-{count}", "--quiet"])
            fronts = [(folder / name / "front.csv").read_bytes() for name in ("whole", f"merged-{count}")]
            seconds = [s for s, _ in times]
            print(f"{count:>6}{sum(seconds):12.1f} s{max(seconds):8.2f} s{max(mb for _, mb in times):9.0f}"
                  f"{merge_s:8.1f} s{merge_mb:9.0f}{megabytes(parts):6.1f} MB{'yes' if fronts[0] == fronts[1] else 'NO':>7}", flush=True)


if __name__ == "__main__":
    main()
