#!/usr/bin/env python3
"""Pareto filter and 3-D hypervolume beside moocore, on the same files, answers compared.

Point sets: a cube (small front), a sphere (every point on the front), a thick shell, whole numbers (many ties), the
sphere with every point four times, points on a line, and points whose staircase never shrinks. Each is written to a
file that both programs read; times are processor time of the call alone, the best of
three. Prints one line a set: points,
front, seconds of both on one thread, their ratio, whether the fronts are the same, relative difference of volumes.

    pip install moocore numpy            # outside the repository
    cargo build --release --example front_speed
    python3 benches/peers/moocore_front.py [POINTS ...]
"""

import os
import subprocess
import sys
import tempfile
import time

import moocore
import numpy as np

REFERENCE = (2.0, 2.0, 2.0)
REPEATS = 3
EXE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../target/release/examples/front_speed")


def sphere(rng, n):
    p = np.abs(rng.normal(size=(n, 3))) + 1e-9
    return 1.5 - p / np.linalg.norm(p, axis=1)[:, None]


def sets(n):
    rng = np.random.default_rng(n)
    yield "cube", rng.random((n, 3))
    yield "sphere", sphere(rng, n)
    yield "shell", sphere(rng, n) + 0.05 * rng.random((n, 1))
    yield "whole numbers", np.floor((sphere(rng, n)) * 100) / 100
    yield "sphere, 4 of each", rng.permutation(np.repeat(sphere(rng, n // 4), 4, axis=0))
    line = rng.permutation(n)[:, None] / n
    yield "line", np.hstack([np.zeros((n, 1)), line, 1 - line])
    yield "long staircase", np.hstack([line, (7919 * line) % 1, 1 - (7919 * line) % 1])


def ours(file, mask):
    args = [EXE, file, ",".join(map(str, REFERENCE)), mask, str(REPEATS)]
    env = {**os.environ, "RAYON_NUM_THREADS": "1"}
    out = subprocess.run(args, capture_output=True, text=True, check=True, env=env).stdout
    return [float(x) for x in out.split()]


def timed(call):
    best, answer = float("inf"), None
    for _ in range(REPEATS):
        started = time.process_time()
        answer = call()
        best = min(best, time.process_time() - started)
    return best, answer


def main():
    counts = [int(float(a)) for a in sys.argv[1:]] or [10**5, 10**6, 10**7]
    print(f"moocore {moocore.__version__}; processor seconds, one thread; ratio: moocore's time over ours")
    head = ("set", "points", "front", "filter", "ours", "ratio", "same", "volume", "ours", "ratio", "differ by")
    print("{:18} {:>9} {:>9} {:>9} {:>9} {:>6} {:>5} {:>9} {:>9} {:>6} {:>9}".format(*head))
    for n in counts:
        for name, points in sets(n):
            with tempfile.TemporaryDirectory() as folder:
                file, mask = os.path.join(folder, "points"), os.path.join(folder, "mask")
                np.ascontiguousarray(points, dtype="<f8").tofile(file)
                filter_s, theirs = timed(lambda: moocore.is_nondominated(points, keep_weakly=True))
                volume_s, volume = timed(lambda: moocore.hypervolume(points, ref=REFERENCE))
                our_filter_s, our_volume_s, our_volume = ours(file, mask)
                same = "yes" if np.array_equal(np.fromfile(mask, dtype=np.uint8).astype(bool), theirs) else "NO"
                print(f"{name:18} {n:9d} {theirs.sum():9d} {filter_s:9.3f} {our_filter_s:9.3f} "
                      f"{filter_s / our_filter_s:6.1f} {same:>5} {volume_s:9.3f} {our_volume_s:9.3f} "
                      f"{volume_s / our_volume_s:6.1f} {abs(our_volume / volume - 1):9.1e}", flush=True)


if __name__ == "__main__":
    main()
