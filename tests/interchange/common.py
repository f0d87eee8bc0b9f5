"""What the comparisons share: running the program, and a table with limits."""
import json
import os
import subprocess
import sys


def armwright(binary, *words):
    done = subprocess.run([binary, "--quiet", *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"armwright {' '.join(map(str, words))}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def export(binary, folder, arm, cases, form, *flags):
    """Writes arm and cases into a folder, exports the first case, and gives the record of the export."""
    os.makedirs(folder, exist_ok=True)
    for name, value in (("arm.json", arm), ("cases.json", cases)):
        with open(os.path.join(folder, name), "w") as file:
            json.dump(value, file)
    out = os.path.join(folder, form)
    armwright(binary, "export", f"{folder}/arm.json", "--cases", f"{folder}/cases.json", "--to", form, "--out", out, *flags)
    with open(os.path.join(out, "export.json")) as file:
        return out, json.load(file)


def norm(vector):
    return sum(x * x for x in vector) ** 0.5


def apart(found, expected):
    """Relative distance of two vectors."""
    return norm([a - b for a, b in zip(found, expected)]) / norm(expected)


class Table:
    """Rows of differences, each with its limit."""

    def __init__(self):
        self.bad = 0

    def row(self, name, differences):
        cells = []
        for what, value, limit in differences:
            over = not value <= limit
            self.bad += over
            cells.append(f"{what} {value:.2e}{' > ' + format(limit, '.0e') + ' FAILED' if over else ''}")
        print(f"{name:34} " + "   ".join(cells), flush=True)

    def end(self):
        sys.exit(1 if self.bad else 0)
