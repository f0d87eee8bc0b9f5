"""Imports robots from URDF files and compares the torques of 50 poses with MuJoCo, which reads the same files.

usage: mujoco_import.py BINARY FOLDER URDF:TIP ...    needs numpy and mujoco
"""
import json
import os
import re
import sys
import xml.etree.ElementTree as ET

import mujoco
import numpy as np

from common import Table, armwright

POSES, TORQUE_NM = 50, 1e-6


def load(path):
    """The robot of a file. Shapes need files that are not there; fixed joints stay, and tensors that no solid has are balanced."""
    text = re.sub(r"<(visual|collision)>.*?</\1>", "", open(path).read(), flags=re.S)
    text = re.sub(r"<mimic[^>]*/>", "", text)
    text = re.sub(r"(<robot[^>]*>)", r'\1<mujoco><compiler fusestatic="false" balanceinertia="true" boundmass="1e-9" boundinertia="1e-12"/></mujoco>', text, count=1)
    return mujoco.MjModel.from_xml_string(text)


def mimics(path):
    found = {}
    for joint in ET.parse(path).getroot().findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            found[joint.get("name")] = (mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
    return found


def angle(name, angles, follows):
    """Angle of a joint, and its slope with respect to each joint that is given; others stand at zero."""
    if name in follows:
        driver, factor, offset = follows[name]
        value, slopes = angle(driver, angles, follows)
        return factor * value + offset, {joint: factor * slope for joint, slope in slopes.items()}
    return (angles[name], {name: 1.0}) if name in angles else (0.0, {})


def main(binary, folder, robots):
    table = Table()
    for robot in robots:
        path, tip = robot.rsplit(":", 1)
        name = os.path.basename(path)
        out = os.path.join(folder, name)
        armwright(binary, "import", path, "--tip", tip, "--out", out)
        with open(os.path.join(out, "import.json")) as file:
            moving = [j for j in json.load(file)["joints"] if j.get("coupled") is None]
        joints = [j["name"] for j in moving]
        slides = np.array([j["type"] == "prismatic" for j in moving])
        # rad, and a tenth of that many metres
        poses = np.random.default_rng(7).uniform(-2.5, 2.5, (POSES, len(joints))) * np.where(slides, 0.1, 1)
        keys = [f"{name}_{'mm' if slide else 'deg'}" for name, slide in zip(joints, slides)]
        entries = np.where(slides, 1e3 * poses, np.degrees(poses))
        with open(os.path.join(out, "cases.json"), "w") as file:
            json.dump([{"name": str(i), "pose": dict(zip(keys, pose))} for i, pose in enumerate(entries)], file)
        found = json.loads(armwright(binary, "analyze", f"{out}/arm.json", "--cases", f"{out}/cases.json", "--json"))
        m, follows, worst, largest = load(path), mimics(path), 0.0, 0.0
        d = mujoco.MjData(m)
        for pose, ours in zip(poses, found):
            angles, slopes = dict(zip(joints, pose)), []
            for j in range(m.njnt):
                value, slope = angle(m.joint(j).name, angles, follows)
                d.qpos[m.jnt_qposadr[j]] = value
                slopes.append(slope)
            mujoco.mj_forward(m, d)
            holding = {**ours["joint_torque_nm"], **ours.get("joint_force_n", {})}
            for joint in joints:
                # what the drive of a joint holds of itself and of those that follow it
                theirs = -sum(slope.get(joint, 0.0) * d.qfrc_bias[m.jnt_dofadr[j]] for j, slope in enumerate(slopes))
                worst = max(worst, abs(theirs - holding[joint]))
                largest = max(largest, abs(theirs))
        table.row(f"{name} ({len(joints)} joints, to {largest:.0f} Nm)", [(f"torque Nm or N, {POSES} poses" if slides.any() else f"torque Nm, {POSES} poses", worst, TORQUE_NM)])
    table.end()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
