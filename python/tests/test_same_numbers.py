"""The package gives the numbers that the program prints, to the last digit."""

import csv
import json

import armwright
import numpy as np
import pytest
from conftest import ROOT

MEASURED = ROOT / "examples" / "measured-arm"


def test_analyze_equals_the_programs_json(program):
    pose = [10.0, -30.0, 45.0, 20.0, -15.0, 5.0]
    arm = MEASURED / "arm.json"
    pose = pose[: len(armwright.driven_joints(arm))]
    text = program(
        "analyze", arm, "--json", "--pose-deg", ",".join(map(str, pose)), "--payload-kg", 5, "--payload-cg-m", "0.05,0,0",
        "--response-n", "0,0,1", "--response-hz", "5,50,4",
    )  # fmt: skip
    ours = armwright.analyze(
        arm, pose, payload_kg=5, payload_cg_m=[0.05, 0, 0], response_n=[0, 0, 1], response_hz=np.linspace(5, 50, 4)
    )
    assert ours == json.loads(text)


def test_cases_equal_the_programs_json(program, tmp_path, lever):
    cases = [{"name": "level", "pose_deg": [0]}, {"name": "up", "pose_deg": [-60], "tip_force_n": [0, 1, 0]}]
    (tmp_path / "arm.json").write_text(json.dumps(lever))
    (tmp_path / "cases.json").write_text(json.dumps(cases))
    text = program("analyze", tmp_path / "arm.json", "--json", "--cases", tmp_path / "cases.json")
    assert armwright.analyze(lever, cases=cases) == json.loads(text)
    assert armwright.analyze(tmp_path / "arm.json", cases=tmp_path / "cases.json") == json.loads(text)


def test_size_and_capacity_equal_the_programs_json(program):
    assert armwright.size("light-arm") == json.loads(program("size", "light-arm", "--json"))
    assert armwright.capacity("light-arm") == json.loads(program("capacity", "light-arm", "--json"))


@pytest.mark.parametrize("search", ["exhaustive", "exact"])
def test_a_front_equals_the_programs_front(program, tmp_path, search, bench_arm):
    study = tmp_path / "bench-arm.json"
    study.write_text(json.dumps(bench_arm))
    flags = ["--gap", "0%"] if search == "exact" else []
    program("run", study, "--search", search, *flags, "--out", tmp_path / "out", "--quiet")
    front = armwright.run(study, search=search, gap_percent=0 if flags else None)
    assert front.to_csv() == (tmp_path / "out" / "front.csv").read_text()
    run = json.loads((tmp_path / "out" / "run.json").read_text())
    same = ["study", "status", "search", "designs_total", "front_size", "hypervolume", "gap", "ties_listed"]
    assert {key: front.facts[key] for key in same} == {key: run[key] for key in same}
    for material in run["materials"]:
        path = tmp_path / "out" / f"front.{material['slug']}.csv"
        theirs = path.read_text() if path.exists() else None
        assert theirs is None or front.by_material[material["name"]].to_csv() == theirs


def test_a_design_equals_the_programs_design(program, tmp_path, bench_arm):
    study = tmp_path / "bench-arm.json"
    study.write_text(json.dumps(bench_arm))
    program("run", study, "--search", "exhaustive", "--out", tmp_path / "out", "--quiet")
    front = armwright.run(study, search="exhaustive")
    chosen = front.lightest()
    program("design", tmp_path / "out", chosen, "--out", tmp_path / "arm")
    assert front.arm(chosen) == json.loads((tmp_path / "arm" / "arm.json").read_text())
    assert front.cases(chosen) == json.loads((tmp_path / "arm" / "cases.json").read_text())
    solved = armwright.analyze(front.arm(chosen), cases=front.cases(chosen))
    deflection_mm = max(np.linalg.norm(case["tip_displacement_m"]) * 1e3 for case in solved)
    # the objectives of a front are those of the full model: sums in another order, hence not the last digits
    assert deflection_mm == pytest.approx(front["tip_deflection_mm"][0], rel=1e-9)


def test_a_verdict_equals_the_programs_verdict(program, tmp_path):
    campaign = ROOT / "examples" / "paper-frequencies"
    program("reconcile", campaign, "--out", tmp_path / "out")
    found = armwright.reconcile(campaign)
    found.write(tmp_path / "ours")
    for name in ["verdict.txt", "arm.corrected.json", "residuals.csv"]:
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "out" / name).read_bytes(), name
    ours, theirs = (json.loads((tmp_path / folder / "verdict.json").read_text()) for folder in ["ours", "out"])
    # what the program notes of its catalogs and files, to know a verdict of the same inputs again and to find changes
    del theirs["catalogs_hash"], theirs["files"]
    assert ours == theirs


def test_a_prediction_equals_the_programs_prediction(program):
    arm, readings, campaign = MEASURED / "arm.json", MEASURED / "static.csv", MEASURED / "campaign.json"
    text = program("predict", arm, readings, "--campaign", campaign)
    ours = armwright.predict(arm, readings, campaign)
    theirs = list(csv.reader(text.splitlines()))
    assert ours.columns == theirs[0]
    assert np.array_equal(ours["model_dz_mm"], [float(row[theirs[0].index("model_dz_mm")]) for row in theirs[1:]])
