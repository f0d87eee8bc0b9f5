"""Loads exported arms into MuJoCo and compares torques, deflection and frequencies with what the export says must be found.

usage: mujoco_export.py BINARY FOLDER [NAME-OF-AN-ARM ...]    needs numpy and mujoco
"""
import os
import sys

import mujoco
import numpy as np

from arms import arms, sliding_arms
from common import Table, apart, export

# rigid links are the same mechanics: what remains is rounding, and 1e-10 of the mass for bodies that MuJoCo wants to have one
TORQUE_NM, TIP, MODE = 1e-6, 1e-6, 1e-4
# servos hold the deflected arm for this time, with the time step of the file. What moves the tip, relative to its deflection, is
# that the torques belong to the pose with straight springs, and that MuJoCo keeps a rigid coupling by a stiff damped spring
HELD_S, MOVES = 0.2, 0.01
# stiffness of the servos: with the inertia at the motor they would vibrate at this frequency
SERVO_HZ = 20
# links of 24 parts: the error of a uniformly loaded cantilever is 1/(2 N^2), that of frequencies below it
PARTS, FLEXIBLE = 24, 2e-3


def mass_matrix(m, d):
    """The mass matrix of a model, by the function of its version of MuJoCo."""
    mass = np.zeros((m.nv, m.nv))
    try:
        mujoco.mj_fullM(m, mass, d.qM)
    except (TypeError, AttributeError):
        mujoco.mj_fullM(m, d, mass)
    return mass


def solve(path):
    """Torques of the motors, deflection of the tip with the springs at rest under the load, and frequencies, motors held."""
    m = mujoco.MjModel.from_xml_path(path)
    d = mujoco.MjData(m)
    mujoco.mj_resetDataKeyframe(m, d, m.key("pose").id)
    mujoco.mj_forward(m, d)
    mass = mass_matrix(m, d)
    hinges = np.asarray(m.jnt_stiffness, float).reshape(m.njnt, -1)[:, 0][m.dof_jntid]
    stiffness = np.diag(hinges)
    preload = hinges * m.qpos_spring[m.jnt_qposadr[m.dof_jntid]]
    # a passive joint follows the others of its tendon, or hangs on them by the spring of its tendon
    follow = np.eye(m.nv)
    transmit = np.eye(m.nv)
    passive = []
    for t in range(m.ntendon):
        wraps = range(m.tendon_adr[t], m.tendon_adr[t] + m.tendon_num[t])
        terms = [(m.jnt_dofadr[m.wrap_objid[w]], m.wrap_prm[w]) for w in wraps]
        for dof, coefficient in terms[1:]:
            transmit[terms[0][0], dof] = -coefficient / terms[0][1]
        transmit[terms[0][0], terms[0][0]] = 0
        spring = np.ravel(m.tendon_stiffness[t])[0]
        if spring > 0:
            length = np.zeros(m.nv)
            for dof, coefficient in terms:
                length[dof] = coefficient
            stiffness = stiffness + spring * np.outer(length, length)
            preload = preload + spring * np.ravel(m.tendon_lengthspring[t])[0] * length
            continue
        for dof, coefficient in terms[1:]:
            follow[terms[0][0], dof] = -coefficient / terms[0][1]
        follow[terms[0][0], terms[0][0]] = 0
        passive.append(terms[0][0])
    load = follow.T @ -d.qfrc_bias
    motors = {m.actuator(a).name: m.jnt_dofadr[m.actuator_trnid[a, 0]] for a in range(m.nu)}
    springs = [v for v in range(m.nv) if v not in passive and v not in motors.values()]
    stiffness = (follow.T @ stiffness @ follow)[np.ix_(springs, springs)]
    jacobian = np.zeros((3, m.nv))
    mujoco.mj_jacSite(m, d, jacobian, None, m.site("tip").id)
    tip = (jacobian @ follow)[:, springs] @ np.linalg.solve(stiffness, (load + follow.T @ preload)[springs])
    soft = np.linalg.inv(np.linalg.cholesky(stiffness))
    inner = soft @ (follow.T @ mass @ follow)[np.ix_(springs, springs)] @ soft.T
    values = np.sort(np.linalg.eigvalsh(inner))[::-1]
    values = values[values > 1e-13 * values[0]]
    # at rest the spring of a tendon hands on what a rigid coupling would
    at_motors = transmit.T @ -d.qfrc_bias
    return {name: at_motors[dof] for name, dof in motors.items()}, tip, 1 / np.sqrt(values) / 2 / np.pi, m.body_mass.sum()


def held(path, expected):
    """Warnings of MuJoCo while servos hold the arm from the keyframe `deflected`, and the largest distance that the tip moves [m]."""
    m = mujoco.MjModel.from_xml_path(path)
    d = mujoco.MjData(m)
    mujoco.mj_resetDataKeyframe(m, d, m.key("deflected").id)
    mujoco.mj_forward(m, d)
    mass = mass_matrix(m, d)
    for a in range(m.nu):
        d.ctrl[a] = -expected[m.actuator(a).name]
        joint = m.actuator_trnid[a, 0]
        dof = m.jnt_dofadr[joint]
        servo = mass[dof, dof] * (2 * np.pi * SERVO_HZ) ** 2
        np.asarray(m.jnt_stiffness).reshape(m.njnt, -1)[joint, 0] = servo
        np.asarray(m.dof_damping).reshape(m.nv, -1)[dof, 0] = servo / (2 * np.pi * SERVO_HZ)
        m.qpos_spring[m.jnt_qposadr[joint]] = d.qpos[m.jnt_qposadr[joint]]
    mujoco.mj_forward(m, d)
    start = d.site("tip").xpos.copy()
    moved = 0.0
    for _ in range(30):
        mujoco.mj_step(m, d, nstep=int(np.ceil(HELD_S / 30 / m.opt.timestep)))
        moved = max(moved, float(np.linalg.norm(d.site("tip").xpos - start)))
    return sum(warning.number for warning in d.warning), moved


def compare(table, name, path, record, limits, holds=True):
    torques, tip, frequencies, mass = solve(path)
    expected = record["expected"]
    holding = {**expected["joint_torque_nm"], **expected.get("joint_force_n", {})}
    torque = max(abs(nm - holding[joint]) for joint, nm in torques.items())
    known = expected["frequencies_hz"][:3]
    mode = max(abs(a / b - 1) for a, b in zip(frequencies, known))
    rows = [("torque Nm", torque, limits[0]), ("tip", apart(tip, expected["tip_displacement_m"]), limits[1]), ("three modes", mode, limits[2])]
    whole = record["mass_kg"] + record["effects_mass_kg"] + record["case"]["payload"]["mass_kg"]
    rows.append(("mass", abs(mass / whole - 1), 1e-7))
    if holds:
        warnings, moved = held(path, holding)
        rows += [("warnings", warnings, 0), ("moves", moved / np.linalg.norm(expected["tip_displacement_m"]), MOVES)]
    table.row(name, rows)


def main(binary, folder, names):
    table = Table()
    for name, arm, cases in arms() + sliding_arms():
        if names and name not in names:
            continue
        here = os.path.join(folder, arm["name"])
        out, record = export(binary, here, arm, cases, "mjcf")
        compare(table, name, os.path.join(out, "arm.xml"), record, (TORQUE_NM, TIP, MODE))
        if name in ("boxes", "layup", "bodies", "random 1", "arm on a rail"):
            out, record = export(binary, here, arm, cases, "mjcf", "--flexible", PARTS)
            compare(table, f"{name}, {PARTS} parts", os.path.join(out, "arm.xml"), record, (TORQUE_NM, FLEXIBLE, FLEXIBLE), holds=False)
    table.end()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
