"""Runs CalculiX on exported arms and compares with what the export says must be found. Standard library only.

usage: calculix.py BINARY FOLDER [NAME-OF-AN-ARM ...]    all arms without names; ccx must be on the PATH
"""
import os
import re
import subprocess
import sys
import time

from arms import arms
from common import Table, apart, export

# solids are not beams: cross-sections warp and change their shape, and root faces are held rigid
TIP, MODE = 5e-3, 1e-2
# open sections warp when they twist, which rigid faces prevent: of this arm the mode without twist is compared
IN_PLANE = {"I beam in the plane of its web": 1}


def run(folder, deck):
    done = subprocess.run(["ccx", deck], cwd=folder, capture_output=True, text=True,
                          env=dict(os.environ, OMP_NUM_THREADS="1", CCX_NPROC_EQUATION_SOLVER="1"))
    path = os.path.join(folder, deck + ".dat")
    text = open(path).read() if os.path.exists(path) else ""
    if "*ERROR" in done.stdout or not text:
        sys.exit(f"{folder}/{deck}: ccx failed\n" + "\n".join(l for l in done.stdout.splitlines() if "ERROR" in l))
    return text


def tip(text):
    found = re.search(r"displacements.*?\n\n\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)", text)
    return [float(x) for x in found.groups()]


def frequencies(text):
    table = text[text.index("E I G E N V A L U E   O U T P U T"):text.index("P A R T I C I P A T I O N")]
    rows = [line.split() for line in table.splitlines()]
    return [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]


def main(binary, folder, names):
    table = Table()
    for name, arm, cases in arms():
        if names and name not in names:
            continue
        started = time.time()
        out, record = export(binary, os.path.join(folder, arm["name"]), arm, cases, "calculix")
        expected = record["expected"]
        displacement = tip(run(out, "static"))
        found = frequencies(run(out, "modes"))[:3]
        known = expected["frequencies_hz"][:3]
        if name in IN_PLANE:
            found, known = [min(found, key=lambda hz: abs(hz - known[IN_PLANE[name]]))], [known[IN_PLANE[name]]]
        worst = max(abs(a / b - 1) for a, b in zip(found, known))
        what = "mode in its plane" if name in IN_PLANE else "three modes"
        table.row(name, [("tip", apart(displacement, expected["tip_displacement_m"]), TIP), (what, worst, MODE)])
        if os.environ.get("VERBOSE"):
            print("   ", displacement, expected["tip_displacement_m"], found, expected["frequencies_hz"][:3], f"{time.time() - started:.1f} s")
    table.end()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
