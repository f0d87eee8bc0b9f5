"""The package by itself: inputs, faults, progress, interruption, tables."""

import json
import os
import signal
import threading
import time

import armwright
import numpy as np
import pytest


def test_a_lever_bears_its_weight(lever):
    solved = armwright.analyze(lever)
    # 2 kg at half a metre; the spring turns by torque over stiffness, and the tip is a metre away
    assert solved["joint_torque_nm"]["j1"] == pytest.approx(9.81, rel=1e-12)
    assert solved["tip_displacement_m"][2] == pytest.approx(-9.81 / 1e4, rel=1e-12)


def test_dicts_paths_and_text_are_the_same_arm(lever, tmp_path):
    path = tmp_path / "arm.json"
    path.write_text(json.dumps(lever))
    answers = [armwright.analyze(arm, [30.0]) for arm in (lever, path, str(path), json.dumps(lever))]
    assert all(answer == answers[0] for answer in answers)
    assert armwright.analyze(lever, np.array([30.0])) == answers[0]


def test_all_faults_of_an_arm_are_in_the_exception(lever):
    lever["chain"][0]["stifness_nm_per_rad"] = 1
    lever["chain"][1]["mass_kg"] = -2
    with pytest.raises(armwright.InputError) as raised:
        armwright.analyze(lever)
    faults = raised.value.faults
    assert [fault.field for fault in faults] == ["chain[0].stifness_nm_per_rad", "chain[1].mass_kg"]
    assert all(fault.file == "arm" and fault.line and fault.message for fault in faults)
    assert "did you mean" in faults[0].message + faults[0].hint
    assert isinstance(raised.value, ValueError)


def test_numbers_that_json_lacks_are_a_fault(lever):
    lever["chain"][1]["mass_kg"] = float("nan")
    with pytest.raises(armwright.InputError):
        armwright.analyze(lever)


def test_each_reason_has_its_exception(bench_arm, tmp_path):
    with pytest.raises(armwright.UsageError, match="compare-materials"):
        armwright.run("compare-material")
    with pytest.raises(armwright.FileError):
        armwright.analyze(tmp_path / "none.json")
    with pytest.raises(armwright.UsageError):
        armwright.size(bench_arm, design="zzzzzzz")
    with pytest.raises(armwright.UsageError):
        armwright.run(bench_arm, search="quick")
    bench_arm["constraints"]["tip_deflection_max_mm"] = 1e-6
    with pytest.raises(armwright.InfeasibleError, match="relax"):
        armwright.run(bench_arm)
    bench_arm["drives"]["ratios"] = [1]
    with pytest.raises((armwright.EmptySpaceError, armwright.InputError)):
        armwright.size(bench_arm)


def test_faulty_catalogs_name_every_row(tmp_path):
    (tmp_path / "materials.csv").write_text("name,density_kg_m3\nsteel,heavy\n")
    with pytest.raises(armwright.CatalogError) as raised:
        armwright.Catalogs.load(tmp_path)
    assert raised.value.faults


def test_catalogs_are_read_once_and_shared(lever):
    catalogs = armwright.Catalogs.builtin()
    assert "gears" in repr(catalogs) and "HFUC-50-100" in catalogs.gears
    assert armwright.analyze(lever, catalogs=catalogs) == armwright.analyze(lever)


def test_a_front_is_arrays_and_a_data_frame(bench_arm):
    pandas = pytest.importorskip("pandas")
    front = armwright.run(bench_arm, search="exhaustive")
    assert front.status == "complete" and len(front) > 1
    assert front.objectives.shape == (len(front), 3)
    assert np.all(np.diff(front["mass_kg"]) >= 0)
    frame = front.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == front.columns
    assert frame["mass_kg"].dtype == float and frame["design_id"][0] == front.ids[0]
    # no design dominates another: smaller deflection and mass, higher mode
    goals = front.objectives * [1, 1, -1]
    for row in goals:
        assert not np.any(np.all(goals <= row, axis=1) & np.any(goals < row, axis=1))


def test_fronts_do_not_depend_on_threads(bench_arm):
    assert armwright.run(bench_arm, threads=1).to_csv() == armwright.run(bench_arm, threads=3).to_csv()


def endless():
    """A study that takes hours."""
    return armwright.study("full-catalog")


def test_progress_is_told_and_its_exception_ends_the_search():
    seen = []

    class Enough(Exception):
        pass

    def progress(state):
        seen.append(state)
        if len(seen) == 3:
            raise Enough

    with pytest.raises(Enough):
        armwright.run(endless(), search="exact", gap_percent=0, progress=progress)
    assert [state["elapsed_s"] for state in seen] == sorted(state["elapsed_s"] for state in seen)
    assert set(seen[-1]) == {"elapsed_s", "designs", "designs_total", "gap", "front_size", "boxes_open"}


@pytest.mark.skipif(os.name == "nt", reason="a signal to oneself ends a process on Windows")
def test_ctrl_c_ends_a_search_and_other_threads_run_meanwhile():
    counted = []

    def count():
        until = time.monotonic() + 1.0
        while time.monotonic() < until:
            counted.append(None)
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=count)
    started = time.monotonic()
    thread.start()
    with pytest.raises(KeyboardInterrupt) as raised:
        armwright.run(endless(), search="exact", gap_percent=0)
    thread.join()
    assert isinstance(raised.value, armwright.Interrupted)
    # the lock was free: the other thread counted all the while (100 at best)
    assert len(counted) > 5
    assert time.monotonic() - started < 120


def test_a_campaign_has_a_verdict(tmp_path):
    from conftest import ROOT

    found = armwright.reconcile(ROOT / "examples" / "paper-frequencies")
    assert found.verdict in ("no_gap", "explained", "unexplained", "insufficient_data")
    assert found.corrected_arm["chain"] and len(found.residuals) > 0
    assert found.text and found.json["verdict"] == found.verdict


URDF = """<robot name="two"><link name="base"/>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="hand"/>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
  <joint name="f" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.8 0 0"/></joint></robot>"""


def test_a_urdf_becomes_an_arm(tmp_path):
    path = tmp_path / "two.urdf"
    path.write_text(URDF)
    arm = armwright.from_urdf(path, "hand", stiffness={"j": 2e4})
    torque_nm = 2 * 9.81 * 0.4
    solved = armwright.analyze(arm)
    assert solved["joint_torque_nm"]["j"] == pytest.approx(torque_nm, rel=1e-12)
    assert solved["tip_displacement_m"][2] == pytest.approx(-torque_nm / 2e4 * 0.8, rel=1e-9)
    rigid = armwright.from_urdf(URDF, "hand")
    assert np.linalg.norm(armwright.analyze(rigid)["tip_displacement_m"]) == 0
    with pytest.raises(armwright.InputError, match="hand"):
        armwright.from_urdf(path, "finger")
    with pytest.raises(armwright.FileError):
        armwright.from_urdf(tmp_path / "none.urdf", "hand")


def test_the_paper_is_computed():
    files = armwright.paper("paper-table1")
    tables = [value for value in files.values() if isinstance(value, armwright.Table)]
    assert tables and all(len(table) for table in tables)


def test_the_stub_names_what_the_native_part_has():
    import ast
    import importlib.resources

    from armwright import _armwright

    text = (importlib.resources.files(armwright) / "_armwright.pyi").read_text()
    stubbed = {node.name for node in ast.parse(text).body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    native = {name for name in dir(_armwright) if not name.startswith("__")}
    assert stubbed == native
