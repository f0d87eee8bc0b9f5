"""The package by itself: inputs, faults, progress, interruption, tables."""

import json
import os
import signal
import threading
import time

import armwright
import numpy as np
import pytest
from conftest import ROOT, URDF


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


def test_numbers_that_json_lacks_are_faults_with_their_fields(lever):
    lever["chain"][1]["mass_kg"] = float("nan")
    lever["chain"][1]["vector_m"] = np.array([1, 0, np.inf])
    with pytest.raises(armwright.InputError, match="2 faults") as raised:
        armwright.analyze(lever)
    assert [fault.field for fault in raised.value.faults] == ["chain[1].vector_m[2]", "chain[1].mass_kg"]
    with pytest.raises(armwright.InputError, match=r"\[0\].pose_deg\[0\]: is nan"):
        armwright.analyze(lever | {"chain": lever["chain"][:1]}, [float("nan")])


def test_what_a_response_cannot_have_is_refused(lever):
    for wrong in [{"damping": -1}, {"damping": np.nan}, {"response_hz": [-1]}, {"response_hz": [np.inf]}]:
        with pytest.raises(armwright.UsageError, match=next(iter(wrong))):
            armwright.analyze(lever, response_n=[0, 0, 1], **wrong)
    for force_n in [[0, 0, np.nan], [1, 0]]:
        with pytest.raises(armwright.UsageError, match="response_n"):
            armwright.analyze(lever, response_n=force_n)
    with pytest.raises(TypeError, match="response_hz without response_n"):
        armwright.analyze(lever, response_hz=[1])
    with pytest.raises(armwright.UsageError, match="modes"):
        armwright.analyze(lever, modes=-1)


def test_cases_do_not_silently_lose_a_load(lever):
    cases = [{"name": "level", "pose_deg": [0]}]
    for argument in [{"pose": [0]}, {"payload_kg": 3}, {"force_n": [0, 0, 1]}, {"links": "rigid"}]:
        with pytest.raises(TypeError, match=next(iter(argument))):
            armwright.analyze(lever, cases=cases, **argument)
    with pytest.raises(armwright.UsageError, match="cases and limits are for arms"):
        armwright.capacity("light-arm", cases=cases)
    with pytest.raises(armwright.UsageError, match="give limits with"):
        armwright.capacity(lever)


def test_what_a_search_cannot_have_is_refused(bench_arm):
    for wrong in [{"gap_percent": np.nan}, {"gap_percent": -1}, {"gap_percent": 100}, {"time_limit_s": -1},
                  {"time_limit_s": np.nan}, {"threads": -1}]:  # fmt: skip
        with pytest.raises(armwright.UsageError, match=next(iter(wrong))):
            armwright.run(bench_arm, **wrong)
    with pytest.raises(TypeError, match="progress"):
        armwright.run(bench_arm, progress=3)
    # messages have the words of a call and not those of the command line
    with pytest.raises(armwright.UsageError, match='^gap_percent goes with search="exact"'):
        armwright.run(bench_arm, search="exhaustive", gap_percent=1)
    with pytest.raises(armwright.UsageError, match="armwright.paper has it"):
        armwright.run("paper-table1")
    with pytest.raises(armwright.UsageError, match="armwright.paper"):
        armwright.study("paper-table1")
    with pytest.raises(armwright.UsageError, match="compare-materials"):
        armwright.study("compare-material")


def test_a_file_of_another_kind_is_said_to_be_what_it_is(bench_arm):
    arm = ROOT / "examples" / "measured-arm" / "arm.json"
    for ask in [armwright.run, armwright.size]:
        with pytest.raises(armwright.InputError, match="is an arm, and a study is asked for") as raised:
            ask(arm)
        assert len(raised.value.faults) == 1
    with pytest.raises(armwright.InputError, match="is a study, and an arm is asked for"):
        armwright.analyze(bench_arm)
    # a study that lacks its poses is a faulty study, and no arm
    del bench_arm["poses"]
    with pytest.raises(armwright.InputError, match="poses"):
        armwright.run(bench_arm)


def test_files_of_every_encoding_and_name_are_read_or_refused_as_faults(bench_arm, tmp_path):
    folder = tmp_path / "Prüfstand 中"
    folder.mkdir()
    text = json.dumps(bench_arm)
    for encoding in ["utf-8", "utf-8-sig"]:
        path = folder / f"{encoding}.json"
        path.write_text(text, encoding=encoding)
        front = armwright.run(path)
        path.unlink()
        # the study is the one that was read, whatever became of its file
        assert front.arm(front.ids[0])["chain"]
    (folder / "utf-16.json").write_text(text, encoding="utf-16")
    with pytest.raises(armwright.InputError):
        armwright.run(folder / "utf-16.json")
    (folder / "latin.urdf").write_bytes(URDF.replace("two", "zw\xf6lf").encode("latin-1"))
    with pytest.raises(armwright.InputError, match="latin.urdf"):
        armwright.from_urdf(folder / "latin.urdf", "hand")
    with pytest.raises(armwright.FileError, match="not Unicode"):
        armwright.analyze(os.fsdecode(b"arm-\xff.json"))


def test_results_with_remarks_are_the_plain_values_that_they_look_like(lever):
    import copy
    import pickle

    solved = armwright.analyze(lever)
    for again in [pickle.loads(pickle.dumps(solved)), copy.deepcopy(solved), json.loads(json.dumps(solved))]:
        assert again == solved == dict(solved)
    assert pickle.loads(pickle.dumps(solved)).text == solved.text
    front = armwright.run(armwright.study("paper-electric"))
    again = pickle.loads(pickle.dumps(front))
    assert again.to_csv() == front.to_csv() and again.arm(again.ids[0]) == front.arm(front.ids[0])
    sizing = armwright.size("paper-electric")
    assert json.loads(json.dumps(sizing)) == sizing and pickle.loads(pickle.dumps(sizing)).remarks == sizing.remarks


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


def test_catalogs_of_a_folder_go_to_another_process(tmp_path):
    import pickle

    row = "own steel,metal,7850,2.1e11,8.1e10,0.3,a test,third party\n"
    (tmp_path / "materials.csv").write_text("name,class,density_kg_m3,e_pa,g_pa,poisson,source,confidence\n" + row)
    catalogs = armwright.Catalogs.load(tmp_path)
    again = pickle.loads(pickle.dumps(catalogs))
    assert again.folder == tmp_path and "own steel" in again.materials


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


@pytest.mark.skipif(os.name == "nt", reason="a signal to oneself ends a process on Windows")
def test_ctrl_c_ends_the_wait_for_a_verdict():
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    started = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        armwright.reconcile(ROOT / "examples" / "measured-arm")
        # a verdict that came before the signal
        time.sleep(60)
    assert time.monotonic() - started < 30


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_answers_too(lever, bench_arm):
    import multiprocessing

    armwright.run(bench_arm)
    armwright.size(bench_arm)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        sizes = pool.map_async(armwright.size, [bench_arm] * 2).get(timeout=120)
        solved = pool.map_async(armwright.analyze, [lever] * 4).get(timeout=120)
        fronts = pool.map_async(_csv, [bench_arm] * 2).get(timeout=120)
    assert sizes[0] == armwright.size(bench_arm) and solved[0].text
    assert fronts[0] == fronts[1] == armwright.run(bench_arm).to_csv()


def _csv(study):
    return armwright.run(study).to_csv()


def test_threads_ask_at_once(bench_arm):
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(4) as pool:
        fronts = list(pool.map(_csv, [bench_arm] * 4))
    assert len(set(fronts)) == 1


def test_a_campaign_has_a_verdict(tmp_path):
    found = armwright.reconcile(ROOT / "examples" / "paper-frequencies")
    assert found.verdict in ("no_gap", "explained", "unexplained", "insufficient_data")
    assert found.corrected_arm["chain"] and len(found.residuals) > 0
    assert found.text and found.json["verdict"] == found.verdict


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


def test_exports_and_searches_refuse_what_the_program_refuses(lever, bench_arm):
    for pieces in [0, 201, 70_000]:
        with pytest.raises(armwright.UsageError, match="from 1 to 200"):
            armwright.export(lever, "mjcf", pieces_per_link=pieces)
    with pytest.raises(armwright.UsageError, match="for mjcf"):
        armwright.export(lever, "urdf", backlash=True)
    with pytest.raises(armwright.UsageError, match="calculix, mjcf"):
        armwright.export(lever, "step")
    with pytest.raises(TypeError, match="cases have their own payload_kg"):
        armwright.export(lever, "mjcf", payload_kg=1, cases=[{"pose_deg": [0]}])
    for options in [{"within_percent": 2, "within_most": 0}, {"tolerance_percent": {"mass": 2}, "seed": 2**64},
                    {"tolerance_percent": {"mass": 2}, "samples": 0}, {"tolerance_percent": {"weight": 2}},
                    {"within_percent": 0}]:  # fmt: skip
        with pytest.raises(armwright.UsageError):
            armwright.run(bench_arm, **options)
