#!/usr/bin/env python3
"""A genetic algorithm beside the exact search, on the same study and the same evaluation.

NSGA-II of pymoo with a population as large as the true front, one whole number a level (the option's place in its list), crossover and mutation on whole numbers,
duplicates left out; designs are judged by the library. It gets the wall time that `armwright run` took, and that
many times it. Prints for each: designs judged, size of its front, share of the true front it found (to 1e-6 in all
three objectives), and its hypervolume in logarithms of the objectives over that of the true front.

    pip install pymoo numpy              # outside the repository
    cargo build --release --bin armwright --example design_objectives
    python3 benches/peers/nsga2.py [STUDY] [TIMES ...]
"""

import csv
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.core.termination import Termination
from pymoo.indicators.hv import HV
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.optimize import minimize

BUILT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../target/release")
RELEASE = os.environ.get("ARMWRIGHT_RELEASE", BUILT)
SEED = 1


class Designs(Problem):
    """The designs of a study; minimized are ln deflection, ln mass, -ln mode."""

    def __init__(self, study):
        exe = os.path.join(RELEASE, "examples/design_objectives")
        self.judge = subprocess.Popen([exe, study], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        sizes = [int(word) for word in self.judge.stdout.readline().split()]
        self.judged = 0
        super().__init__(n_var=len(sizes), n_obj=3, n_ieq_constr=1, xl=0, xu=np.array(sizes) - 1, vtype=int)

    def _evaluate(self, x, out, *args, **kwargs):
        for row in x:
            self.judge.stdin.write(" ".join(str(int(i)) for i in row) + "\n")
        self.judge.stdin.write("\n")
        self.judge.stdin.flush()
        rows = np.array([[float(w) for w in self.judge.stdout.readline().split()] for _ in x])
        self.judged += len(x)
        out["F"] = logarithms(rows[:, :3])
        out["G"] = rows[:, 3:]


class WallTime(Termination):
    """Ends after some seconds, or a little later: a generation is not cut short."""

    def __init__(self, seconds):
        super().__init__()
        self.seconds, self.started = seconds, time.perf_counter()

    def _update(self, algorithm):
        return (time.perf_counter() - self.started) / self.seconds


def logarithms(objectives):
    mm, kg, hz = np.maximum(objectives, 1e-9).T
    return np.column_stack([np.log(mm), np.log(kg), -np.log(hz)])


def exact(study):
    with tempfile.TemporaryDirectory() as out:
        args = [os.path.join(RELEASE, "armwright"), "run", study, "--search", "exact", "--out", out]
        subprocess.run(args, check=True, capture_output=True)
        # the search alone, without pictures and pages
        seconds = json.load(open(os.path.join(out, "run.json")))["elapsed_s"]
        rows = list(csv.DictReader(open(os.path.join(out, "front.csv"))))
    columns = ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"]
    return seconds, np.array([[float(row[c]) for c in columns] for row in rows])


def main():
    study = sys.argv[1] if len(sys.argv) > 1 else "light-arm"
    seconds, front = exact(study)
    true = np.unique(logarithms(front).round(9), axis=0)
    worst = true.max(axis=0) + 0.1
    volume = HV(ref_point=worst)(true)
    print(f"{study}: exact {seconds:.2f} s, {len(front)} designs, {len(true)} different objectives")
    for times in [float(word) for word in sys.argv[2:]] or [1.0, 100.0]:
        designs = Designs(study)
        algorithm = NSGA2(
            # room for the whole front
            pop_size=max(200, len(true)),
            sampling=IntegerRandomSampling(),
            crossover=SBX(prob=0.9, eta=15, vtype=float, repair=RoundingRepair()),
            mutation=PM(eta=20, vtype=float, repair=RoundingRepair()),
            eliminate_duplicates=True,
        )
        found = minimize(designs, algorithm, WallTime(times * seconds), seed=SEED).F
        designs.judge.stdin.close()
        found = np.empty((0, 3)) if found is None else np.atleast_2d(found)
        share = np.mean([np.any(np.all(np.abs(found - f) < 1e-6, axis=1)) for f in true]) if len(found) else 0.0
        ratio = HV(ref_point=worst)(found) / volume if len(found) else 0.0
        print(
            f"  {times:g} times as long: {designs.judged} judged, front of {len(found)}, "
            f"{100 * share:.1f} % of the true front, hypervolume {ratio:.4f} of it"
        )


if __name__ == "__main__":
    main()
