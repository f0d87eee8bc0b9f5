#!/usr/bin/env python3
"""Pareto filter and 3-D hypervolume beside moocore, on the same files, answers compared.

Point sets: a cube (small front), a sphere (every point on the front), a thick shell, whole numbers (many ties), the
sphere with every point four times, points on a line, and points whose staircase never shrinks. Each is written to a
file that both programs read; times are of the call alone, the best of three. Prints one line a set: points,
front, seconds of both, ratio on one thread and on all, whether the fronts are the same, relative difference of volumes.

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


def ours(file, mask, threads):
    args = [EXE, file, ",".join(map(str, REFERENCE)), mask, str(REPEATS)]
    env = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    out = subprocess.run(args, capture_output=True, text=True, check=True, env=env).stdout
    return [float(x) for x in out.split()]


def timed(call):
    best, answer = float("inf"), None
    for _ in range(REPEATS):
        started = time.perf_counter()
        answer = call()
        best = min(best, time.perf_counter() - started)
    return best, answer


def main():
    counts = [int(float(a)) for a in sys.argv[1:]] or [10**5, 10**6, 10**7]
    threads = os.cpu_count()
    print(f"moocore {moocore.__version__}; seconds; ratios: moocore's time over ours on 1 and on {threads} threads")
    head = ("set", "points", "front", "filter", "ours 1", f"ours {threads}", "ratios", "same",
            "volume", "ours 1", f"ours {threads}", "ratios", "differ by")
    print("{:18} {:>9} {:>9} {:>9} {:>8} {:>8} {:>12} {:>5} {:>9} {:>8} {:>8} {:>12} {:>9}".format(*head))
    for n in counts:
        for name, points in sets(n):
            with tempfile.TemporaryDirectory() as folder:
                file, mask = os.path.join(folder, "points"), os.path.join(folder, "mask")
                np.ascontiguousarray(points, dtype="<f8").tofile(file)
                filter_s, theirs = timed(lambda: moocore.is_nondominated(points, keep_weakly=True))
                volume_s, volume = timed(lambda: moocore.hypervolume(points, ref=REFERENCE))
                (f1, v1, _), (f2, v2, our_volume) = ours(file, mask, 1), ours(file, mask, threads)
                same = "yes" if np.array_equal(np.fromfile(mask, dtype=np.uint8).astype(bool), theirs) else "NO"
                print(f"{name:18} {n:9d} {theirs.sum():9d} {filter_s:9.3f} {f1:8.3f} {f2:8.3f} "
                      f"{filter_s / f1:5.1f} {filter_s / f2:6.1f} {same:>5} {volume_s:9.3f} {v1:8.3f} {v2:8.3f} "
                      f"{volume_s / v1:5.1f} {volume_s / v2:6.1f} {abs(our_volume / volume - 1):9.1e}", flush=True)


if __name__ == "__main__":
    main()
