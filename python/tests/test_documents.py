"""The Python of docs/python.md runs from its beginning to its end."""

import importlib.util
import re
import shutil

import pytest
from conftest import ROOT, URDF

PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)

MJCF = """<mujoco><worldbody><body name="arm"><joint name="j1" axis="0 1 0"/><geom size="0.1" mass="2" pos="0.5 0 0"/>
  <body name="tool0" pos="1 0 0"/></body></worldbody></mujoco>"""


def test_the_page_has_code():
    assert len(BLOCKS) >= 4


def test_the_code_of_the_page_runs(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    for campaign in ["may", "june"]:
        shutil.copytree(ROOT / "examples" / "measured-arm", tmp_path / "campaigns" / campaign)
    (tmp_path / "robot.xml").write_text(MJCF)
    (tmp_path / "robot.urdf").write_text(URDF)
    names = {}
    for block in BLOCKS:
        if "mujoco" in block and importlib.util.find_spec("mujoco") is None:
            continue
        exec(compile(block, "docs/python.md", "exec"), names)
    assert (tmp_path / "results" / "may" / "verdict.json").is_file()
