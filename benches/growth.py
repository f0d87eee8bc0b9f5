#!/usr/bin/env python3
"""How the processor time and the memory of the sweep grow with poses, joints, given pieces, options and designs.

cargo build --release --example speed; python3 benches/growth.py [poses joints given options designs]

Every arm is whole: drives by first fit with output bearings and motor heat, links that bend, modes in space. One thread.
ns = processor time / (designs evaluated x pieces x poses); `next` is the ratio of a row's ns to that of the row above, and
the exponent is the slope of log(processor time per design) over log(pieces x poses), or of log(processor time) over log(designs)."""

import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SPEED = Path(__file__).resolve().parent.parent / "target/release/examples/speed"
LINE = re.compile(r"(\d+) designs, (\d+) evaluated, ([0-9.]+) s of one core.*peak (\d+) MB")


def sections(sides, walls):
    grid = lambda low, high, n: [round(low + (high - low) * i / max(n - 1, 1), 4) for i in range(n)]
    return [{"shape": "rectangular_tube", "width_mm": grid(80, 160, sides), "height_mm": "=width", "wall_mm": grid(2, 6, walls)}]


def link(name, vector_m, sides=16, walls=16):
    return {"type": "link", "name": name, "vector_m": vector_m,
            "choose": {"materials": ["Structural steel S355", "Aluminium 6061-T6"], "sections": sections(sides, walls)}}


def offset(name, vector_m):
    return {"type": "link", "name": name, "vector_m": vector_m}


def tube(name, vector_m):
    return {"type": "link", "name": name, "vector_m": vector_m, "material": "Aluminium 6082-T6",
            "section": {"shape": "round_tube", "diameter_m": 0.16, "wall_m": 0.006}}


def joint(name, axis):
    return {"type": "joint", "name": name, "axis": axis, "drive": "first_fit"}


def study(joints=6, poses=3, column="offset", bases=0, sides=16, walls=16):
    """An arm of two open links; `bases` given offsets stand below joint 1, and `joints - 3` wrist joints follow the elbow."""
    dice = random.Random(7)
    y, x, z = [0, 1, 0], [1, 0, 0], [0, 0, 1]
    chain = [offset(f"base_{i + 1}", [0, 0, 0.01]) for i in range(bases)]
    chain += [joint("j1", z), (tube if column == "tube" else offset)("shoulder", [0, 0, 0.3])] if joints > 2 else []
    chain += [joint("j2", y), link("upper_arm", [0.6, 0, 0], sides, walls), joint("j3", y), link("forearm", [0.45, 0, 0], sides, walls)]
    for wrist in range(joints - 3 if joints > 2 else 0):
        chain += [joint(f"j{4 + wrist}", x if wrist % 2 == 0 else y), offset(f"wrist_{wrist + 1}", [0.3 / (joints - 3), 0, 0])]
    angles = lambda: [round(dice.uniform(-60, 60), 1) for _ in range(joints)]
    return {"name": "growth", "question": "how fast?", "chain": chain, "payload": {"mass_kg": 4, "cg_m": [0, 0, 0.05]},
            "poses": [{"pose_deg": angles()} for _ in range(poses)], "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.2},
            "drives": {"gear_series": ["CSG"], "ratios": [100], "motors": ["electric"]}}


def measured(question):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(question, file)
        file.flush()
        runs = [subprocess.run([SPEED, file.name], capture_output=True, text=True) for _ in range(2)]
    found = [LINE.search(run.stdout) for run in runs]
    if not all(found):
        sys.exit(f"{SPEED} failed:\n{runs[0].stdout}{runs[0].stderr}")
    best = min(found, key=lambda m: float(m.group(3)))
    designs, evaluated, seconds, peak_mb = (float(best.group(i)) for i in range(1, 5))
    return designs, evaluated, seconds, peak_mb, len(question["chain"]), len(question["poses"])


def table(title, what, values, by_designs=False):
    print(f"\n{title}\n{what:>10}{'designs':>12}{'evaluated':>12}{'s':>9}{'MB':>7}{'ns':>9}{'next':>7}")
    before, points = None, []
    for value, question in values:
        designs, evaluated, seconds, peak_mb, pieces, poses = measured(question)
        ns = 1e9 * seconds / (evaluated * pieces * poses)
        ratio = f"{ns / before:7.2f}" if before else ""
        print(f"{value:>10}{designs:12.0f}{evaluated:12.0f}{seconds:9.2f}{peak_mb:7.0f}{ns:9.2f}{ratio}", flush=True)
        before = ns
        x, t = (evaluated, seconds) if by_designs else (pieces * poses, seconds / evaluated)
        points.append((math.log(x), math.log(t)))
    if len({x for x, _ in points}) > 1:
        print(f"exponent {slope(points):.2f}")


def slope(points):
    n, sx, sy = len(points), sum(x for x, _ in points), sum(y for _, y in points)
    return (n * sum(x * y for x, y in points) - sx * sy) / (n * sum(x * x for x, _ in points) - sx * sx)


TABLES = {
    "poses": lambda: table("Poses, all judged and all sizing; six joints", "poses",
                           [(n, study(poses=n)) for n in [1, 2, 3, 4, 6, 7, 8, 9, 10, 16, 17, 24, 32, 40]]),
    "joints": lambda: table("Joints, three poses", "joints", [(n, study(joints=n)) for n in range(2, 11)]),
    "given": lambda: (
        table("Given pieces below joint 1", "pieces", [(f"{n}", study(bases=n)) for n in [0, 4, 8, 9, 10, 12, 16]]),
        table("The column between joints 1 and 2", "column", [(c, study(column=c)) for c in ["offset", "tube"]])),
    "options": lambda: table("Options of each link", "options",
                             [(2 * s * w, study(sides=s, walls=w)) for s, w in [(5, 5), (7, 7), (10, 10), (14, 14), (20, 20)]], True),
    "designs": lambda: table("Designs, one pose, rigid wrist", "options",
                             [(2 * s * s, study(joints=3, poses=1, sides=s, walls=s)) for s in [22, 40, 70]], True),
}

if __name__ == "__main__":
    for name in sys.argv[1:] or TABLES:
        TABLES[name]()
