"""What the tests share: the program next to which the package is held, and inputs."""

import json
import os
import subprocess
from pathlib import Path

import pytest

# scripts/test-python runs a copy of the tests next to the installed wheel
ROOT = Path(os.environ.get("ARMWRIGHT_ROOT", Path(__file__).resolve().parents[2]))

LEVER = {
    "name": "lever",
    "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "l1", "vector_m": [1, 0, 0], "mass_kg": 2},
    ],
}

URDF = """<robot name="two"><link name="base"/>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="hand"/>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
  <joint name="f" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.8 0 0"/></joint></robot>"""


@pytest.fixture
def lever():
    return json.loads(json.dumps(LEVER))


@pytest.fixture
def bench_arm():
    """A study of 288 designs, as a dict: the bench arm with the lightest drive at both joints."""
    study = json.loads((ROOT / "examples" / "bench-arm.json").read_text())
    study["chain"][0]["drive"] = "first_fit"
    return study


@pytest.fixture
def program():
    """Runs the program and returns its standard output."""
    path = os.environ.get("ARMWRIGHT_PROGRAM")
    if not path:
        pytest.skip("set ARMWRIGHT_PROGRAM to the program of the same version (scripts/test-python does)")

    def run(*args):
        done = subprocess.run([path, *map(str, args)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
