#!/usr/bin/env python3
"""A genetic algorithm beside the exact search, on the same study and the same evaluation.

NSGA-II of pymoo, one whole number a level (the option's place in its list), duplicates left out; designs are judged by the library.
Three variants: simulated binary crossover with polynomial mutation; uniform crossover with a random option in one level of
each design on average; and the latter with a quarter of the population. The best of the three counts. Each gets the processor
time of the whole command `armwright run` (search, pages and all), and so many times it; its own is that of Python and of
the library. Prints for each: designs judged, size of its front, share of the true front it found (to 1e-6 in all three
objectives), and its hypervolume in logarithms of the objectives over that of the true front.

With a gap (`full-catalog:2%`) the exact search ends there, and the share is that of the designs that it listed.

    pip install pymoo numpy              # outside the repository
    cargo build --release --bin armwright --example design_objectives
    python3 benches/peers/nsga2.py [STUDY[:GAP]] [TIMES ...]
"""

import csv
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.core.termination import Termination
from pymoo.indicators.hv import HV
from pymoo.core.mutation import Mutation
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.crossover.ux import UX
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

    def processor_s(self):
        fields = open(f"/proc/{self.judge.pid}/stat").read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _evaluate(self, x, out, *args, **kwargs):
        for row in x:
            self.judge.stdin.write(" ".join(str(int(i)) for i in row) + "\n")
        self.judge.stdin.write("\n")
        self.judge.stdin.flush()
        rows = np.array([[float(w) for w in self.judge.stdout.readline().split()] for _ in x])
        self.judged += len(x)
        out["F"] = logarithms(rows[:, :3])
        out["G"] = rows[:, 3:]


class RandomOption(Mutation):
    """Gives each level a random option with the probability of one level a design."""

    def _do(self, problem, x, **kwargs):
        dice = np.random.default_rng(len(x) + int(x.sum()))
        random = np.floor(dice.random(x.shape) * (problem.xu + 1)).astype(int)
        return np.where(dice.random(x.shape) < 1 / problem.n_var, random, x)


class ProcessorTime(Termination):
    """Ends after some seconds of processor time, of Python and of the library, or a little later."""

    def __init__(self, seconds, designs):
        super().__init__()
        self.seconds, self.designs, self.started = seconds, designs, time.process_time()

    def _update(self, algorithm):
        return (time.process_time() - self.started + self.designs.processor_s()) / self.seconds


def logarithms(objectives):
    mm, kg, hz = np.maximum(objectives, 1e-9).T
    return np.column_stack([np.log(mm), np.log(kg), -np.log(hz)])


def exact(study, gap):
    with tempfile.TemporaryDirectory() as out:
        args = [os.path.join(RELEASE, "armwright"), "run", study, "--search", "exact", "--out", out]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(args + (["--gap", gap] if gap else []), check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        rows = list(csv.DictReader(open(os.path.join(out, "front.csv"))))
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    columns = ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"]
    return seconds, np.array([[float(row[c]) for c in columns] for row in rows])


def variants(front):
    """Crossover and mutation, and a population with room for the whole front or for a quarter of it."""
    room = min(max(200, front), 4000)
    sbx = dict(crossover=SBX(prob=0.9, eta=15, vtype=float, repair=RoundingRepair()), mutation=PM(eta=20, vtype=float, repair=RoundingRepair()))
    uniform = dict(crossover=UX(prob=0.9), mutation=RandomOption())
    return [("binary", room, sbx), ("uniform", room, uniform), ("uniform, small", max(100, room // 4), uniform)]


def main():
    study, _, gap = (sys.argv[1] if len(sys.argv) > 1 else "light-arm").partition(":")
    seconds, front = exact(study, gap)
    true = np.unique(logarithms(front).round(9), axis=0)
    worst = true.max(axis=0) + 0.1
    volume = HV(ref_point=worst)(true)
    print(f"{study}: exact search{f' to {gap}' if gap else ''} {seconds:.1f} s of processor time, {len(front)} designs, {len(true)} different objectives", flush=True)
    for times in [float(word) for word in sys.argv[2:]] or [1.0, 2.0, 5.0, 10.0]:
        for name, room, operators in variants(len(true)):
            designs = Designs(study)
            algorithm = NSGA2(pop_size=room, sampling=IntegerRandomSampling(), eliminate_duplicates=True, **operators)
            found = minimize(designs, algorithm, ProcessorTime(times * seconds, designs), seed=SEED, copy_termination=False).F
            designs.judge.stdin.close()
            found = np.empty((0, 3)) if found is None else np.atleast_2d(found)
            share = np.mean([np.any(np.all(np.abs(found - f) < 1e-6, axis=1)) for f in true]) if len(found) else 0.0
            ratio = HV(ref_point=worst)(found) / volume if len(found) else 0.0
            print(
                f"  {times:g} times as long, {name}: {designs.judged} judged, front of {len(found)}, "
                f"{100 * share:.1f} % of the listed designs, hypervolume {ratio:.4f}", flush=True
            )


if __name__ == "__main__":
    main()
