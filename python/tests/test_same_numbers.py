"""The package gives the numbers that the program prints, to the last digit."""

import csv
import json

import armwright
import numpy as np
import pytest
from conftest import ROOT, URDF

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


def words(text):
    """A text without the breaks of its lines."""
    return " ".join(text.split())


def test_analyze_says_in_words_what_the_program_says(program):
    text = program("analyze", MEASURED / "arm.json", "--payload-kg", 5)
    ours = armwright.analyze(MEASURED / "arm.json", payload_kg=5)
    assert ours.text and ours.remarks and "arm mass" in ours.text
    assert words(ours.text + " ".join(ours.remarks)) == words(text)


def test_a_response_has_the_frequencies_and_the_damping_of_the_program(program):
    text = program("analyze", MEASURED / "arm.json", "--json", "--response-n", "0,0,1")
    assert armwright.analyze(MEASURED / "arm.json", response_n=[0, 0, 1]) == json.loads(text)


def test_size_and_capacity_equal_the_programs_json(program):
    sizing = armwright.size("light-arm")
    assert sizing == json.loads(program("size", "light-arm", "--json"))
    assert sizing.remarks
    assert words(program("size", "light-arm")).endswith(words(" ".join(sizing.remarks)))
    capacity = armwright.capacity("light-arm")
    assert capacity == json.loads(program("capacity", "light-arm", "--json"))
    assert any("Left out" in remark for remark in capacity["remarks"])


def test_the_capacity_of_an_arm_equals_the_programs_json(program, tmp_path, lever):
    lever["chain"][0]["stiffness_nm_per_rad"] = None
    cases = [{"name": "level", "pose_deg": [0]}, {"name": "up", "pose_deg": [-60]}]
    limits = {"joints": [{"name": "j1", "max_torque_nm": 50}]}
    for name, value in [("arm", lever), ("cases", cases), ("limits", limits)]:
        (tmp_path / f"{name}.json").write_text(json.dumps(value))
    arm = tmp_path / "arm.json"
    flags = ["--limits", tmp_path / "limits.json"]
    theirs = json.loads(program("capacity", arm, "--json", *flags, "--cases", tmp_path / "cases.json"))
    # 2 kg at half a metre and the payload at a metre
    assert theirs["payload_kg"] == pytest.approx(50 / 9.81 - 1)
    assert armwright.capacity(arm, cases=tmp_path / "cases.json", limits=tmp_path / "limits.json") == theirs
    assert armwright.capacity(lever, cases=cases, limits={"j1": 50}) == theirs
    assert armwright.capacity(lever, limits=limits) == json.loads(program("capacity", arm, "--json", *flags))
    # limits that stand beside the arm file, and those of a robot in the arm's own dict
    (tmp_path / "limits.json").rename(tmp_path / "import.json")
    assert armwright.capacity(arm) == json.loads(program("capacity", arm, "--json"))


def test_the_capacity_of_a_robot_has_the_limits_of_its_file(program, tmp_path):
    robot = tmp_path / "robot.urdf"
    limited = '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="60" velocity="1"/>'
    robot.write_text(URDF.replace('<axis xyz="0 1 0"/>', limited).replace("continuous", "revolute"))
    program("import", robot, "--tip", "hand", "--out", tmp_path / "arm")
    theirs = json.loads(program("capacity", tmp_path / "arm" / "arm.json", "--json"))
    assert theirs["payload_kg"] == pytest.approx((60 / 9.81 - 2 * 0.4) / 0.8)
    assert armwright.capacity(armwright.from_urdf(robot, "hand")) == theirs


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
    said = ["remarks", "caveats", "not_checked", "models", "constraints", "cases", "effects", "effects_mass_kg"]
    assert {key: front.facts[key] for key in same + said} == {key: run[key] for key in same + said}
    assert front.picks == {name: pick["design_id"] for pick in run["picks"] for name in pick["names"]}
    assert front.picks["lightest"] == front.lightest() and "knee" in front.picks
    assert front.remarks == run["remarks"] + [run["caveats"]] * bool(run["caveats"]) + run["not_checked"]
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
    assert theirs["not_written"] == []
    for key in ["catalogs_hash", "files", "manifest_hash", "not_written"]:
        del theirs[key]
    assert ours == theirs


def test_a_prediction_equals_the_programs_prediction(program):
    arm, readings, campaign = MEASURED / "arm.json", MEASURED / "static.csv", MEASURED / "campaign.json"
    text = program("predict", arm, readings, "--campaign", campaign)
    ours = armwright.predict(arm, readings, campaign)
    theirs = list(csv.reader(text.splitlines()))
    assert ours.columns == theirs[0]
    in_memory = armwright.predict(json.loads(arm.read_text()), readings, campaign)
    assert in_memory.to_csv() == ours.to_csv() and in_memory.remark == ours.remark
    assert np.array_equal(ours["model_dz_mm"], [float(row[theirs[0].index("model_dz_mm")]) for row in theirs[1:]])


def test_a_prediction_of_a_verdict_is_that_of_its_written_arm(tmp_path):
    campaign = ROOT / "examples" / "paper-frequencies"
    found = armwright.reconcile(campaign)
    found.write(tmp_path)
    files = campaign / "modal.csv", campaign / "campaign.json"
    written = armwright.predict(tmp_path / "arm.corrected.json", *files)
    assert armwright.predict(found, *files).to_csv() == written.to_csv()


def test_the_remarks_on_a_front_are_those_of_its_gears_and_not_of_its_study_alone(program, tmp_path, bench_arm):
    # the built-in gears of one series, under another name and with backlash
    rows = list(csv.DictReader((ROOT / "catalogs" / "gears.csv").read_text(encoding="utf-8").splitlines()))
    loose = {"series": "PG", "alias_series": "", "kind": "planetary", "backlash_arcmin": "9"}
    parts = tmp_path / "parts"
    parts.mkdir()
    with open(parts / "gears.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows({**row, **loose} for row in rows if row["series"] == "CSG")
    bench_arm["drives"]["gear_series"] = ["PG"]
    study = tmp_path / "study.json"
    study.write_text(json.dumps(bench_arm))
    program("--catalogs", parts, "run", study, "--out", tmp_path / "out", "--quiet")
    run = json.loads((tmp_path / "out" / "run.json").read_text())
    front = armwright.run(study, catalogs=armwright.Catalogs.load(parts))
    assert sum("loose by up to" in remark for remark in front.remarks) == 2, front.remarks
    assert front.facts["remarks"] == run["remarks"] and front.facts["caveats"] == run["caveats"]


def written(folder):
    """The files of a folder by name, without those whose names begin with a point."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith(".")}


def test_an_export_has_the_files_of_the_program(program, tmp_path, lever, bench_arm):
    arm = tmp_path / "arm.json"
    arm.write_text(json.dumps(lever))
    for to in ["calculix", "mjcf", "urdf", "json", "csv", "bom"]:
        program("export", arm, "--payload-kg", 2, "--pose-deg", 30, "--to", to, "--out", tmp_path / to)
        exported = armwright.export(lever, to, pose=[30], payload_kg=2)
        assert exported.files == written(tmp_path / to) and exported.json["to"] == to
    study = tmp_path / "bench-arm.json"
    study.write_text(json.dumps(bench_arm))
    program("run", study, "--search", "exhaustive", "--out", tmp_path / "out", "--quiet")
    front = armwright.run(study, search="exhaustive")
    chosen = front.picks["knee"]
    flags = ["--to", "mjcf", "--flexible", 4, "--out", tmp_path / "knee"]
    program("export", f"{tmp_path / 'out'}#{chosen}", *flags)
    exported = front.export(chosen, "mjcf", pieces_per_link=4)
    assert exported.files == written(tmp_path / "knee")
    paths = exported.write(tmp_path / "again")
    assert written(tmp_path / "again") == exported.files and len(paths) == len(exported.files)


@pytest.mark.parametrize("search", ["exhaustive", "exact"])
def test_near_designs_and_scatter_are_those_of_the_program(program, tmp_path, search, bench_arm):
    study = tmp_path / "bench-arm.json"
    study.write_text(json.dumps(bench_arm))
    out = tmp_path / "out"
    gap = ["--gap", "0%"] if search == "exact" else []
    asked = ["--within", "5%", "--tolerance", "gear_stiffness=20%,mass=2.5%", "--samples", 200, "--seed", 7]
    program("run", study, "--search", search, *gap, *asked, "--out", out, "--quiet")
    front = armwright.run(
        study, search=search, gap_percent=0 if gap else None, within_percent=5,
        tolerance_percent={"gear_stiffness": 20, "mass": 2.5}, samples=200, seed=7,
    )  # fmt: skip
    assert front.near.to_csv() == (out / "near.csv").read_text() and len(front.near)
    assert front.scatter.to_csv() == (out / "tolerance.csv").read_text()
    run = json.loads((out / "run.json").read_text())
    keys = ["within", "tolerance"]
    assert [front.facts[key] for key in keys] == [run[key] for key in keys]
    plain = armwright.run(study, search=search)
    assert plain.near is None and plain.scatter is None
    assert [plain.facts[key] for key in keys] == [None, None]


def test_a_study_with_the_effects_of_a_measured_arm_is_that_of_the_program(program, tmp_path, bench_arm):
    study, arm = tmp_path / "bench-arm.json", tmp_path / "arm.corrected.json"
    study.write_text(json.dumps(bench_arm))
    joint = bench_arm["chain"][0]["name"]
    measured = armwright.run(bench_arm, search="exhaustive")
    measured = measured.arm(measured.lightest())
    measured["effects"] = [{"effect": "bearing_tilt", "at": joint, "parameters": {"stiffness_nm_per_rad": 2e4}}]
    arm.write_text(json.dumps(measured))
    program("run", study, "--search", "exhaustive", "--effects", arm, "--out", tmp_path / "out", "--quiet")
    for effects in [measured, arm]:
        front = armwright.run(study, search="exhaustive", effects=effects)
        assert front.to_csv() == (tmp_path / "out" / "front.csv").read_text()
    run = json.loads((tmp_path / "out" / "run.json").read_text())
    assert front.facts["carried_over"] == run["carried_over"] and front.facts["carried_over"][0]["carried"]
    # the designs of this front have the effect too
    assert front.arm(front.lightest())["effects"] == measured["effects"]
    with pytest.raises(armwright.UsageError, match="changes nothing in the study"):
        armwright.run(study, effects={**measured, "effects": []})
