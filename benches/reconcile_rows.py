#!/usr/bin/env python3
"""How `armwright reconcile` grows with the rows of a campaign: processor time, wall time and peak memory.

    cargo build --release
    python3 benches/reconcile_rows.py target/release/armwright [--kinds positions,static] [--rows 100,...,100000]

Campaigns are made with `armwright predict`: the arm of examples/measured-arm with an effect that the campaign's arm lacks,
in random poses, with noise.

- `positions`: a point on the tool, in the frame of a tracker that is moved after two fifths of the rows. Base placement,
  tool offset, joint offsets and geometry are free; the real arm's links differ by half a millimetre and a bearing tilts.
- `static`: displacements under five loads in each pose; a bearing tilts.

Of each row of the table: processor seconds of all threads, wall seconds, peak resident memory, and the exponent of the processor
time from the size before. Below it the exponent fitted to all sizes from 1000 rows on, in logarithms, by least squares.
"""

import argparse
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOMINAL = ROOT / "examples/measured-arm/arm.json"
EFFECT = {"effect": "bearing_tilt", "at": "j2", "parameters": {"stiffness_nm_per_rad": 150000.0}}
JOINTS = [f"j{i}" for i in range(1, 7)]
POSE = [f"q_{joint}_deg" for joint in JOINTS]
PAYLOAD = ["payload_kg", "payload_cg_x_m", "payload_cg_y_m", "payload_cg_z_m"]
SESSION_MM = (0.4, -0.3, 0.2)  # how far the tracker was moved
FITTED_FROM = 1000  # rows; below, what does not grow dominates


def pose(dice):
    return [round(dice.uniform(-120.0, 120.0), 1) for _ in JOINTS]


def position_rows(dice, count):
    for index in range(count):
        load = [dice.choice([0, 2.5, 5, 10]), 0.08, 0.0, 0.0]
        yield [index + 1, *pose(dice), *load, "tip", 0, 0, 0, 0.05]


def static_rows(dice, count):
    for index in range(count):
        if index % 5 == 0:
            angles = pose(dice)
        kg = [2.5, 5, 10, 5, 0][index % 5]
        force = [round(dice.uniform(-90.0, 90.0), 1) for _ in range(3)] if kg == 0 else [0, 0, 0]
        branch = "unloading" if index % 5 == 3 else "loading"
        yield [index + 1, *angles, kg, 0.08, 0.0, 0.0, *force, branch, 0, 0, 0, 0.006]


KINDS = {
    "positions": (position_rows, ["point", "x_mm", "y_mm", "z_mm", "sigma_mm"], "xyz"),
    "static": (static_rows, ["force_x_n", "force_y_n", "force_z_n", "branch", "dx_mm", "dy_mm", "dz_mm", "sigma_mm"],
               ["dx", "dy", "dz"]),
}


def statement(kind):
    """What campaign.json says."""
    out = {"name": kind, "arm": "arm.json", "tolerance": {"joint_stiffness": 0.05, "modulus": 0.02, "joint_mass": 0.01}}
    if kind == "positions":
        free = ["base_placement", "tool_offset", "joint_offsets", "geometry"]
        return out | {"positions": {name: True for name in free}}
    return out | {"static": {"file": "static.csv"}}


def real_arm(dice, kind):
    """The arm that is measured: the nominal one with an effect, and for positions with lengths of its own."""
    arm = json.loads(NOMINAL.read_text())
    arm["effects"] = [EFFECT]
    if kind == "positions":
        for link in (element for element in arm["chain"] if element["type"] == "link"):
            link["vector_m"] = [x + dice.gauss(0.0, 5e-4) for x in link["vector_m"]]
    return arm


def measured(dice, kind, index, count, mm):
    """A reading with its noise; positions as the tracker sees them."""
    if kind == "static":
        return [x + dice.gauss(0.0, 0.006) for x in mm]
    x, y, z = mm
    turned = (0.8 * x - 0.6 * y + 2000.0, 0.6 * x + 0.8 * y - 500.0, z + 300.0)
    moved = [a + b for a, b in zip(turned, SESSION_MM)] if 5 * index >= 2 * count else turned
    return [a + dice.gauss(0.0, 0.05) for a in moved]


def make(binary, folder, kind, count):
    """Writes a campaign of `count` rows into a folder."""
    dice = random.Random(f"{kind} {count}")
    rows, columns, axes = KINDS[kind]
    (folder / "campaign.json").write_text(json.dumps(statement(kind)))
    (folder / "arm.json").write_text(NOMINAL.read_text())
    (folder / "real.json").write_text(json.dumps(real_arm(dice, kind)))
    readings = folder / f"{kind}.csv"
    header = ["test", *POSE, *PAYLOAD, *columns]
    with readings.open("w", newline="") as file:
        csv.writer(file).writerows([header, *rows(dice, count)])
    command = [binary, "predict", folder / "real.json", readings, "--campaign", folder / "campaign.json"]
    predicted = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    with readings.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(header)
        for index, row in enumerate(csv.DictReader(predicted.splitlines())):
            model = [float(row[f"model_{axis}_mm"]) for axis in axes]
            for axis, mm in zip(axes, measured(dice, kind, index, count, model)):
                row[f"{axis}_mm"] = f"{mm:.4f}"
            out.writerow([row[name] for name in header])


def reconciled(binary, folder, limit_s):
    """Processor and wall seconds and peak memory in MB of one reconciliation; and its verdict."""
    begin_s = time.monotonic()
    process = subprocess.Popen([binary, "reconcile", folder, "--out", folder / "out"], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    wall_s = time.monotonic() - begin_s
    if status != 0:
        sys.exit(f"reconcile failed in {folder}")
    verdict = json.loads((folder / "out/verdict.json").read_text())
    effects = [f"{effect['effect']}@{effect['at']}" for effect in verdict["effects"]]
    seconds = used.ru_utime + used.ru_stime
    return seconds, wall_s, used.ru_maxrss / 1024.0, f"{verdict['verdict']} {' '.join(effects)}", seconds > limit_s


def exponent(points):
    """Slope of ln(seconds) over ln(rows), by least squares."""
    logs = [(math.log(rows), math.log(seconds)) for rows, seconds in points]
    mean = [sum(values) / len(logs) for values in zip(*logs)]
    products = sum((x - mean[0]) * (y - mean[1]) for x, y in logs)
    return products / sum((x - mean[0]) ** 2 for x, _ in logs)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", type=Path)
    parser.add_argument("--kinds", default="positions,static")
    parser.add_argument("--rows", default="100,1000,10000,100000")
    parser.add_argument("--limit-s", type=float, default=600.0, help="no larger campaign of a kind after one that took longer")
    args = parser.parse_args()
    binary = args.binary.resolve()
    print(f"{'kind':10} {'rows':>7} {'seconds':>9} {'wall':>7} {'MB':>7} {'exponent':>8}  verdict")
    for kind in args.kinds.split(","):
        points = []
        for count in map(int, args.rows.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                make(binary, Path(folder), kind, count)
                seconds, wall_s, megabytes, verdict, is_over = reconciled(binary, Path(folder), args.limit_s)
            points.append((count, seconds))
            step = f"{exponent(points[-2:]):8.2f}" if len(points) > 1 else " " * 8
            print(f"{kind:10} {count:7} {seconds:9.2f} {wall_s:7.2f} {megabytes:7.0f} {step}  {verdict}", flush=True)
            if is_over:
                break
        fitted = [point for point in points if point[0] >= FITTED_FROM]
        if len(fitted) > 1:
            print(f"{kind}: seconds grow as rows to the power {exponent(fitted):.2f} ({fitted[0][0]} to {fitted[-1][0]} rows)")


if __name__ == "__main__":
    main()
