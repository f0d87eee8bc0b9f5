#!/usr/bin/env python3
"""The simple model (two rigid links, three given joints, stretched) as a NumPy and as a C sweep, beside ours.

The same grid of square tubes as `benches/common/mod.rs`; every pair of sections is one design with its mass, tip
deflection and lowest mode from the rigid eigenproblem. Joint 1 turns about the vertical and does not couple with the other
two, so the largest eigenvalue has a closed form; NumPy gets it both ways, by LAPACK on stacks of 3 x 3 matrices and by
the closed form. The C program (`simple_sweep.c`, written for this one arm) has the closed form too and keeps the lightest design
alone; the general program keeps a front. Prints designs per second of processor time, the ratios, and the lightest design's
objectives, so that it can be seen that all compute the same.

    pip install numpy            # outside the repository
    cargo build --release --example speed
    python3 benches/peers/numpy_sweep.py [DESIGNS]
"""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import math
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

G = 9.81
K = np.array([6.1e5, 6.1e5, 2.3e5])  # N m/rad, j1..j3
MASSES = (12.2, 9.2, 5.0, 20.0)  # j2, j3, payload, j1
LENGTHS = (0.8, 0.5)
DENSITIES = (7850.0, 2700.0)  # replaced by the catalog's figures below


def densities(names=("Structural steel S355", "Aluminium 6061-T6")):
    import csv

    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, "../../catalogs/materials.csv"), newline="") as f:
        rows = {row["name"]: row for row in csv.DictReader(line for line in f if not line.startswith("#"))}
    column = next(c for c in next(iter(rows.values())) if c.startswith("density"))
    return [float(rows[name][column]) for name in names]


def sections(options):
    """Area and polar terms (per density) of the grid, both materials."""
    sides = math.ceil(math.sqrt(options / 2))
    walls = -(-options // (2 * sides))
    b, t = (x.ravel() for x in np.meshgrid(np.linspace(60, 200, sides) / 1e3, np.linspace(2, 10, walls) / 1e3))
    area = b * b - (b - 2 * t) ** 2
    second = (b**4 - (b - 2 * t) ** 4) / 12
    rho = np.array(densities())
    return (rho[:, None] * area).ravel(), (rho[:, None] * second).ravel()


def closed(m11, m22, m23, m33):
    """The larger of the eigenvalue of joint 1 and those of the 2 x 2 block of joints 2 and 3 -> frequency in Hz."""
    a, d, c2 = m22 / K[1], m33 / K[2], m23 * m23 / (K[1] * K[2])
    half = 0.5 * (a - d)
    return 1 / np.sqrt(np.maximum(m11 / K[0], 0.5 * (a + d) + np.sqrt(half * half + c2))) / (2 * math.pi)


def lapack(m11, m22, m23, m33):
    """Largest eigenvalue of C^1/2 M C^1/2 by LAPACK on stacks of 3 x 3 matrices -> frequency in Hz."""
    a = np.zeros((len(m22), 3, 3))
    a[:, 0, 0] = m11 / K[0]
    a[:, 1, 1], a[:, 2, 2] = m22 / K[1], m33 / K[2]
    a[:, 1, 2] = a[:, 2, 1] = m23 / math.sqrt(K[1] * K[2])
    return 1 / np.sqrt(np.linalg.eigvalsh(a)[:, 2]) / (2 * math.pi)


def sweep(options, lowest):
    line, rotary = sections(options)
    (l1, l2), (mj2, mj3, mp, mj1) = LENGTHS, MASSES
    best, count = None, 0
    m1, i1 = line * l1, line * l1**3 / 3 + rotary * l1  # about its root
    for fore, fore_rotary in zip(line, rotary):
        m2 = fore * l2
        about3 = fore * l2**3 / 3 + fore_rotary * l2 + mp * l2**2
        first3 = m2 * l2 / 2 + mp * l2
        outer = mj3 + m2 + mp
        about2 = i1 + about3 + 2 * l1 * first3 + outer * l1**2
        cross = about3 + l1 * first3
        t3 = G * first3
        t2 = G * (m1 * l1 / 2 + first3 + outer * l1)
        tip = t2 / K[1] * (l1 + l2) + t3 / K[2] * l2
        mass = mj1 + mj2 + m1 + outer - mp
        hz = lowest(about2, about2, np.broadcast_to(cross, m1.shape), np.broadcast_to(about3, m1.shape))
        k = int(np.argmin(mass))
        if best is None or mass[k] < best[0]:
            best = (mass[k], tip[k], hz[k])
        count += len(m1)
    return count, best


def in_c(options):
    """The same by `simple_sweep.c`, compiled for this processor; `None` without a C compiler."""
    here = os.path.dirname(os.path.abspath(__file__))
    line, rotary = sections(options)
    with tempfile.TemporaryDirectory() as folder:
        exe = os.path.join(folder, "simple_sweep")
        source = os.path.join(here, "simple_sweep.c")
        try:
            subprocess.run(["cc", "-O3", "-march=native", "-ffast-math", source, "-o", exe, "-lm"], check=True)
        except (OSError, subprocess.CalledProcessError):
            return None
        table = "\n".join(f"{a!r} {b!r}" for a, b in zip(line.tolist(), rotary.tolist()))
        out = subprocess.run([exe, str(len(line))], input=table, capture_output=True, text=True, check=True).stdout.split()
    return int(out[0]), float(out[1]), [float(x) for x in out[2:]]


def told(name, count, seconds, best):
    print(f"{name:<16}{count:>12} designs, {count / seconds:.3e} designs/s/core; lightest {best[0]:.6f} kg, "
          f"{best[1] * 1e3:.6f} mm, {best[2]:.6f} Hz")
    return count / seconds


def main():
    designs = float(sys.argv[1]) if len(sys.argv) > 1 else 1e6
    options, rates = round(math.sqrt(designs)), {}
    for name, lowest in [("numpy, LAPACK", lapack), ("numpy, closed", closed)]:
        started = time.process_time()
        count, best = sweep(options, lowest)
        rates[name] = told(name, count, time.process_time() - started, best)
    c = in_c(round(math.sqrt(100 * designs)))
    if c:
        rates["C, closed"] = told("C, closed", *c)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
    exe = os.path.join(root, "target/release/examples/speed")
    ours = subprocess.run([exe, "simple", str(100 * designs)], capture_output=True, text=True, check=True).stdout
    print("armwright:", ours.strip())
    rate = float(re.search(r"([0-9.e+]+) designs/s/core", ours).group(1))
    print("ratios: " + ", ".join(f"{name} {rate / other:.2f}" for name, other in rates.items()))


if __name__ == "__main__":
    main()
