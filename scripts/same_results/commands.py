"""Which commands both builds run.

A command's arguments may hold
    {out}             its own folder of results
    {out:NAME}        the folder of results of an earlier command
    {pick:NAME:PICK}  the design that an earlier run picked as PICK (lightest, stiffest, highest mode, knee)
"""

import json
import re
import subprocess
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

PLACEHOLDER = re.compile(r"\{(out|pick)(?::([^:}]+))?(?::([^}]+))?\}")

# what takes more than ten seconds of a processor, or needs it
SLOW = ["run/full-catalog", "front/compare-materials", "front/underwater-arm"]


@dataclass(frozen=True)
class Command:
    """One call of armwright; `kind` is what standard output holds: text, json or csv."""

    name: str
    argv: tuple
    kind: str = "text"

    @property
    def needs(self):
        """Names of the commands whose results this one reads."""
        found = (match.group(2) for arg in self.argv for match in PLACEHOLDER.finditer(arg))
        return tuple(dict.fromkeys(name for name in found if name))


def command(name, line, *more):
    """A command from its line; arguments with spaces come apart from it."""
    argv = (*line.split(), *more)
    kind = "json" if "--json" in argv else "csv" if "--csv" in argv else "text"
    return Command(name, argv, kind)


def plan(root, binary, only, quick):
    """All commands, those that others need first, those that take long before all."""
    listed = listed_studies(binary)
    sized = [name for name, own in listed if own]
    everything = [
        *studies([name for name, _ in listed]),
        *reconciled(root),
        *after_reconcile(),
        *fronts(sized),
        *sizes(root, sized),
        *analyses(root),
        *catalogs(),
        *faults(),
        *helps(binary),
    ]
    names = [c.name for c in everything]
    if len(set(names)) != len(names):
        raise ValueError(f"two commands of one name: {sorted(n for n in names if names.count(n) > 1)}")
    return chosen(everything, only, quick)


def chosen(everything, only, quick):
    """The commands that were asked for, and those that they need."""
    by_name = {c.name: c for c in everything}

    def chain(name):
        return {name}.union(*(chain(need) for need in by_name[name].needs))

    def is_slow(name):
        return any(part in SLOW for part in chain(name))

    wanted = {
        part
        for name in by_name
        if (not only or any(fnmatch(name, glob) for glob in only)) and not (quick and is_slow(name))
        for part in chain(name)
    }
    if not wanted:
        raise ValueError("no command has such a name (--list prints all)")
    return [c for c in everything if c.name in wanted]


def printed(binary, *argv):
    return subprocess.run([str(binary), *argv], capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL).stdout


def listed_studies(binary):
    """Names of the built-in studies, and whether each is a study of its own rather than one of the paper's."""
    own, found = True, []
    for line in printed(binary, "studies").splitlines():
        if not line.startswith(" "):
            own = "paper" not in line
        elif (match := re.match(r"  ([a-z0-9][\w-]*) ", line)) is not None:
            found.append((match.group(1), own))
    if not found:
        raise ValueError(f"{binary} lists no studies")
    return found


def studies(names):
    """Every named study, the longest first, and the searches and supplements that they do not ask for."""
    for name in sorted(names, key=lambda name: (name != "full-catalog", name != "compare-materials")):
        yield command(f"run/{name}", f"run {name} --out {{out}}")
    bench = "run examples/bench-arm.json --out {out}"
    yield command("run/bench-arm", bench)
    yield command("run/bench-arm-exact", f"{bench} --search exact --within 2%")
    yield command("run/bench-arm-scatter",
                  f"{bench} --tolerance gear_stiffness=20%,modulus=3%,mass=2% --samples 300 --seed 7 --within 3% --within-most 50")
    yield command("run/bench-arm-own-parts", f"{bench} --catalogs made/my-parts")
    yield command("run/workshop-arm", "run examples/measured-arm/study.json --out {out}")
    yield command("run/stiff-arm-exact", "run stiff-arm --search exact --within 1% --out {out}")
    yield command("run/stiff-arm-gap", "run stiff-arm --search exact --gap 1% --out {out}")
    yield command("run/light-arm-exact", "run light-arm --search exact --out {out}")


def campaigns(root):
    """Folders of campaigns, by name."""
    data = root / "tests/data"
    folders = [
        *(data / "campaigns").iterdir(),
        *(data / "other_simulator").iterdir(),
        *(data / "positions_other_simulator").iterdir(),
        root / "examples/measured-arm",
        root / "examples/paper-frequencies",
    ]
    return {folder.name: folder for folder in sorted(folders) if (folder / "campaign.json").exists()}


READINGS = ["static", "modal", "windup", "positions"]


def reconciled(root):
    """Every campaign reconciled; its readings predicted by its arm and by what came out; the corrected arm analyzed."""
    for name, folder in campaigns(root).items():
        place = folder.relative_to(root)
        yield command(f"reconcile/{name}", f"reconcile {place} --out {{out}}")
        corrected = f"{{out:reconcile/{name}}}/arm.corrected.json"
        for reading in READINGS:
            if not (folder / f"{reading}.csv").exists():
                continue
            rest = f"{place}/{reading}.csv --campaign {place}/campaign.json"
            yield Command(f"predict/{name}/{reading}", tuple(f"predict {place}/arm.json {rest}".split(" ")), "csv")
            yield command(f"predict/{name}/{reading}-corrected", f"predict {corrected} {rest} --out {{out}}/predicted.csv")
        yield command(f"analyze/{name}/corrected", f"analyze {corrected} --payload-kg 2")
        yield command(f"analyze/{name}/corrected-json", f"analyze {corrected} --payload-kg 2 --json")


def after_reconcile():
    """Studies with a measured arm's corrections."""
    yield command("reconcile-study/measured-arm",
                  "reconcile examples/measured-arm --study examples/measured-arm/study.json --out {out}")
    yield command("reconcile-together/measured-twice", "reconcile examples/measured-arm made/measured-again --out {out}")
    corrected = "{out:reconcile/measured-arm}/arm.corrected.json"
    for study in ["examples/measured-arm/study.json", "paper-electric"]:
        name = Path(study).stem
        yield command(f"run-with-effects/{name}", f"run {study} --effects {corrected} --out {{out}}")


def fronts(sized):
    """What is made of finished fronts: designs, their analysis, comparisons, checks."""
    for name in [*sized, "bench-arm", "workshop-arm", "stiff-arm-gap"]:
        run = f"run/{name}"
        for pick in ["lightest", "stiffest", "highest mode", "knee"]:
            design = f"design/{name}/{pick.replace(' ', '-')}"
            yield command(design, f"design {{out:{run}}} --out {{out}}", f"{{pick:{run}:{pick}}}")
            for suffix in ["", " --json"]:
                yield command(f"analyze/{name}/{pick.replace(' ', '-')}{suffix.replace(' --', '-')}",
                              f"analyze {{out:{design}}}/arm.json --cases {{out:{design}}}/cases.json{suffix}")
        yield command(f"compare/{name}", f"compare {{out:{run}}} --out {{out}}")
        yield command(f"front/{name}", f"front check {{out:{run}}}")
    light, stiff, sea, bench = (f"{{out:run/{name}}}" for name in ["light-arm", "stiff-arm", "underwater-arm", "bench-arm"])
    yield command("compare/three-arms", f"compare {light} {stiff} {sea} --out {{out}}")
    limits = "--deflection-mm 1.5,2,3 --mass-kg 20,30,50.5 --mode-hz 4,6"
    yield command("compare/limits", f"compare {light} {stiff} {limits} --out {{out}}")
    yield command("compare/json", f"compare {light} {stiff} --json")
    yield command("compare/materials-json", "compare {out:run/compare-materials} --mass-kg 10,20 --json")
    yield command("compare/one-study", f"compare {bench} {{out:run/bench-arm-own-parts}} --out {{out}}")
    yield command("compare/front-file", f"compare {stiff}/front.csv {light}/front.csv")
    yield command("compare/effects", f"compare {{out:run/workshop-arm}} {{out:run-with-effects/study}} --out {{out}}")
    yield command("size/bench-arm/knee", f"size examples/bench-arm.json --out {{out}} --design {{pick:run/bench-arm:knee}}")
    yield command("size/light-arm/knee", "size light-arm --out {out} --design {pick:run/light-arm:knee}")


def joints(study):
    """Names of the joints of a study whose drives it chooses."""
    return [piece["name"] for piece in study["chain"] if piece["type"] == "joint" and "drive" in piece]


def sizes(root, sized):
    """Every study sized, each joint explained."""
    files = {name: f"studies/{name}.json" for name in sized}
    for name, given in [*((name, name) for name in sized),
                        ("bench-arm", "examples/bench-arm.json"), ("workshop-arm", "examples/measured-arm/study.json")]:
        yield command(f"size/{name}/plain", f"size {given} --out {{out}}")
        yield command(f"size/{name}/json", f"size {given} --json")
        study = json.loads((root / files.get(name, given)).read_text())
        for joint in joints(study):
            yield command(f"size/{name}/explain-{joint}", f"size {given} --explain {joint}")
            yield command(f"size/{name}/all-fits-{joint}", f"size {given} --all-fits {joint}")
    yield command("size/bench-arm/own-parts", "size examples/bench-arm.json --catalogs made/my-parts")


def arms(root):
    """Arm files with their number of joints; those that a file of reference cases holds are written by `write_made`."""
    named = [(f"{folder.name}", folder / "arm.json") for folder in campaigns(root).values()]
    named.append(("right-arm", root / "tests/data/positions_other_simulator/one-point-name-on-two-arms/right.json"))
    for name, path in named:
        if path.exists():
            yield name, path.relative_to(root), count_joints(json.loads(path.read_text()))
    for name, arm in reference_arms(root).items():
        yield name, Path(f"made/arms/{name}.json"), count_joints(arm)


def count_joints(arm):
    """Joints that a pose has an angle for: a coupled one follows others."""
    return sum(piece["type"] == "joint" and "coupled" not in piece for piece in arm["chain"])


def reference_arms(root):
    """The arms that other programs solved, by name."""
    files = [json.loads((root / f"tests/data/{kind}-arms.json").read_text()) for kind in ["planar", "spatial"]]
    return {case["id"]: case["arm"] for file in files for case in file["cases"]}


def analyses(root):
    """Every arm in two poses, with and without payload and force, by every model of links and joints."""
    load = "--payload-kg 3.5 --payload-cg-m 0.04,-0.02,0.1 --payload-inertia-kgm2 0.02,0.03,0.01 --force-n 20,-35.5,10"
    for name, path, count in arms(root):
        bent = "--pose-deg " + ",".join(str([25, -40, 65, 30, -50, 15][i % 6]) for i in range(count))
        flags = {
            "plain": "",
            "json": "--json",
            "loaded": f"{bent} {load}",
            "loaded-json": f"{bent} {load} --modes 4 --json",
            "rigid-k2": f"{bent} {load} --links rigid --joints k2 --json",
            "bending-k1": f"{bent} {load} --links bending --joints three_segment_k1 --json",
            "response": f"{bent} --payload-kg 3.5 --response-n 0,1,-10 --damping 0.03 --response-hz 2,60,30",
            "response-json": f"--response-n 0,0,1 --json",
        }
        for flag, line in flags.items():
            yield command(f"analyze/{name}/{flag}", f"analyze {path} {line}".strip())


def catalogs():
    """The catalogs, checked, listed and part by part."""
    yield command("catalog/check", "catalog check")
    yield command("catalog/check-own-parts", "catalog check --catalogs made/my-parts")
    for parts in ["gears", "motors", "materials", "profiles"]:
        yield command(f"catalog/{parts}", f"catalog show {parts}")
        yield command(f"catalog/{parts}-csv", f"catalog show {parts} --csv")
    filters = {
        "csg-32": "gears --series CSG --size 32", "ratio-100": "gears --ratio 100", "hydraulic": "motors --kind hydraulic",
        "composite": "materials --class composite", "steel": "profiles --family steel", "square": "profiles --shape square",
        "round-csv": "profiles --shape round --csv", "refused": "materials --size 3",
    }
    for name, line in filters.items():
        yield command(f"catalog/{name}", f"catalog show {line}")
    for i, part in enumerate(["HFUC-58-100", "CSG-20-100", "ILM70x18", "F11-10", "J 8.2 (129-)", "Structural steel S355",
                              "CFRP GY-70/epoxy (high modulus) quasi-isotropic", "HFUC-58-101"]):
        yield command(f"catalog/part-{i}", "catalog show --part", part)


def faults():
    """What is refused: exit codes, and the numbers in what is said of it."""
    lines = {
        "unknown-study": "run no-such-study --out {out}",
        "faulty-study": "run made/faulty-study.json --out {out}",
        "infeasible": "run made/infeasible-study.json --out {out}",
        "size-infeasible": "size made/infeasible-study.json",
        "faulty-arm": "analyze made/faulty-arm.json",
        "too-few-angles": "analyze examples/measured-arm/arm.json --pose-deg 1,2",
        "faulty-campaign": "reconcile made/faulty-campaign --out {out}",
        "faulty-parts": "catalog check --catalogs made/faulty-parts",
        "unknown-design": "design {out:run/bench-arm} zzzzzz --out {out}",
        "unknown-joint": "size light-arm --explain j9",
        "given-drive": "size paper-hydraulic --explain j2",
        "other-arms": "reconcile tests/data/campaigns/hard-b7549 tests/data/campaigns/hard-d6dfd --out {out}",
        "no-results": "compare no-such-results",
        "other-catalogs": "design {out:run/bench-arm} 1 --catalogs made/my-parts --out {out}",
        "check-other-catalogs": "front check {out:run/bench-arm} --catalogs made/my-parts",
        "no-threads": "studies --threads 0",
        "no-verb": "",
    }
    for name, line in lines.items():
        yield Command(f"fault/{name}", tuple(line.split()))


def helps(binary, verbs=()):
    """The help of every verb, as the build before lists them."""
    text = printed(binary, *verbs, "--help")
    for flag in ["--help", "-h"]:
        yield Command("/".join(["help", *verbs, flag.strip("-")]), (*verbs, flag))
    below = re.search(r"^Commands:\n((?:(?:  .*)?\n)+)", text, re.MULTILINE)
    for verb in re.findall(r"^  (\w[\w-]*)", below.group(1), re.MULTILINE) if below else []:
        if verb != "help":
            yield from helps(binary, (*verbs, verb))


def write_made(root, folder):
    """Writes what commands read and no file of the project holds: reference arms on their own, own parts, faulty files."""
    (folder / "arms").mkdir(parents=True)
    for name, arm in reference_arms(root).items():
        (folder / f"arms/{name}.json").write_text(json.dumps(arm))
    bench = (root / "examples/bench-arm.json").read_text()
    study = json.loads(bench)
    study.setdefault("constraints", {})["tip_deflection_max_mm"] = 0.001
    (folder / "infeasible-study.json").write_text(json.dumps(study, indent=1))
    negative = re.sub(r'"(mass_kg|tip_speed_m_s)": [\d.]+', r'"\1": -5', bench)
    (folder / "faulty-study.json").write_text(negative.replace("[0, 1, 0]", "[0, 0, 0]", 1))
    arm = (root / "examples/measured-arm/arm.json").read_text()
    arm = arm.replace('"youngs_modulus_pa": 2', '"youngs_modulus_pa": -2').replace('"vector_m"', '"vektor_m"', 1)
    (folder / "faulty-arm.json").write_text(arm)
    write_parts(folder)
    again = folder / "measured-again"
    again.mkdir()
    for name in ["arm.json", "modal.csv"]:
        (again / name).write_text((root / "examples/measured-arm" / name).read_text())
    facts = json.loads((root / "examples/measured-arm/campaign.json").read_text())
    kept = {key: value for key, value in facts.items() if key not in ["static", "windup"]}
    (again / "campaign.json").write_text(json.dumps(kept | {"name": "measured-again"}))
    campaign = folder / "faulty-campaign"
    campaign.mkdir()
    for name in ["campaign.json", "arm.json", "static.csv"]:
        (campaign / name).write_text((root / "tests/data/campaigns/hard-b7549" / name).read_text())
    rows = (campaign / "static.csv").read_text().split("\n")
    rows[3], rows[5] = rows[3].replace(",", ",x", 3), rows[5] + ",7"
    (campaign / "static.csv").write_text("\n".join(rows))


def write_parts(folder):
    """A motor of one's own, and the same with faults."""
    head = ("type,model,vendor,rated_torque_nm,peak_torque_nm,rated_speed_rpm,max_speed_rpm,rotor_inertia_kgm2,mass_kg,"
            "source,confidence\n")
    row = "frameless-servo,SM-60,My Vendor,0.9,3.1,3000,4500,2.6e-05,0.15,data sheet SM-60,verified\n"
    for name, text in [("my-parts", head + row), ("faulty-parts", head + row.replace("3.1", "-3.1").replace("4500", "fast"))]:
        (folder / name).mkdir()
        (folder / name / "motors.csv").write_text(text)
