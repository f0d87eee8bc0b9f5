"""Varied arms with their cases, for comparisons with other programs. Standard library only.

arms() gives (name, arm, cases): every kind of spring, section, body, effect and load that an export carries, and random arms.
"""
import random

STEEL = {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.077e10, "density_kg_m3": 7850, "poisson": 0.3}
ALUMINIUM = {"youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.632e10, "density_kg_m3": 2700, "poisson": 0.33}
# a quasi-isotropic layup for which E and G are near those of an isotropic material, and one far from it
CARBON = {"youngs_modulus_pa": 5.5e10, "shear_modulus_pa": 2.1e10, "density_kg_m3": 1550, "poisson": 0.3}
LAYUP = {"youngs_modulus_pa": 9e10, "shear_modulus_pa": 1.5e10, "density_kg_m3": 1550, "poisson": 0.3}
MATERIALS = {"steel": STEEL, "aluminium": ALUMINIUM, "carbon": CARBON, "layup": LAYUP}


def joint(name, axis, stiffness, mass=0.0, **more):
    return {"type": "joint", "name": name, "axis": axis, "stiffness_nm_per_rad": stiffness, "mass_kg": mass, **more}


def geared(name, axis, k, t1, mass=0.0, **more):
    windup = {"k1_nm_per_rad": k, "k2_nm_per_rad": 1.4 * k, "k3_nm_per_rad": 1.7 * k, "t1_nm": t1, "t2_nm": 3.5 * t1}
    return {"type": "joint", "name": name, "axis": axis, "windup": windup, "mass_kg": mass, **more}


def box(name, vector, material, width, height, wall, **more):
    section = {"shape": "rectangular_tube", "width_m": width, "height_m": height, "wall_m": wall}
    return {"type": "link", "name": name, "vector_m": vector, "material": material, "section": section, **more}


def pipe(name, vector, material, diameter, wall, **more):
    section = {"shape": "round_tube", "diameter_m": diameter, "wall_m": wall}
    return {"type": "link", "name": name, "vector_m": vector, "material": material, "section": section, **more}


def offset(name, vector, mass=0.0, **more):
    return {"type": "link", "name": name, "vector_m": vector, "mass_kg": mass, **more}


def case(name, pose, mass=5.0, cg=(0.05, 0.0, 0.0), inertia=(0.0, 0.0, 0.0), **more):
    payload = {"mass_kg": mass, "cg_m": list(cg), "inertia_about_cg_kgm2": list(inertia)}
    return {"name": name, "pose_deg": pose, "payload": payload, **more}


def arm(name, chain, effects=(), **more):
    return {"name": name, "materials": MATERIALS, "chain": chain, "effects": list(effects), **more}


def bearing(tilt):
    return {"bearing": {"tilt_stiffness_nm_per_rad": tilt, "mass_kg": 0.4}}


def body(mass, cg, size):
    x, y, z = size
    inertia = [[mass * (y * y + z * z) / 12, 0, 0], [0, mass * (x * x + z * z) / 12, 0], [0, 0, mass * (x * x + y * y) / 12]]
    return {"mass_kg": mass, "cg_m": list(cg), "inertia_kgm2": inertia}


def effect(name, at, **parameters):
    return {"effect": name, "at": at, "parameters": parameters}


def wrist(bits=(2.9, 2.9, 2.98), k=(1.08e5, 1.08e5, 1.75e4)):
    return [
        joint("j4", [1, 0, 0], k[0], bits[0]),
        offset("w4", [0.1, 0, 0]),
        joint("j5", [0, 1, 0], k[1], bits[1]),
        offset("w5", [0.08, 0, 0.01], 0.3),
        joint("j6", [1, 0, 0], k[2], bits[2]),
        offset("tool", [0.05, 0, 0]),
    ]


def fixed_arms():
    out = []
    upper, fore = box("upper", [0.8, 0, 0], "steel", 0.16, 0.16, 0.01), box("fore", [0.5, 0, 0], "steel", 0.12, 0.12, 0.01)
    out.append(("boxes", arm("boxes", [joint("j2", [0, 1, 0], 6.07e5), upper, joint("j3", [0, 1, 0], 4.05e5, 8.2), fore, *wrist()]),
                [case("stretched", [0] * 5)]))
    out.append(("curves and bearings", arm("curves", [
        geared("j1", [0, 0, 1], 3e5, 120, 14.0, **bearing(8e5)), box("column", [0, 0, 0.4], "aluminium", 0.2, 0.2, 0.01),
        geared("j2", [0, 1, 0], 2.4e5, 150, 12.0, **bearing(6e5)), box("upper", [0.7, 0, 0], "aluminium", 0.14, 0.16, 0.006),
        geared("j3", [0, 1, 0], 9e4, 40, 7.0, **bearing(3e5)), box("fore", [0.6, 0, 0], "aluminium", 0.1, 0.1, 0.005),
        *wrist()]), [case("bent", [20, -35, 70, 30, -40, 10], 8.0, (0.06, 0.02, 0.01), (0.02, 0.03, 0.025))]))
    out.append(("round tubes", arm("round", [
        joint("j1", [0, 0, 1], 4e5, 10.0), pipe("column", [0, 0, 0.35], "steel", 0.18, 0.008),
        joint("j2", [0, 1, 0], 3e5, 9.0), pipe("upper", [0.75, 0, 0.05], "carbon", 0.13, 0.005),
        joint("j3", [0, 1, 0], 1.5e5, 6.0), pipe("fore", [0.65, 0.02, 0], "carbon", 0.1, 0.004), *wrist()]),
        [case("reach", [-30, 15, 40, -60, 25, 5], 6.0)]))
    out.append(("yielding ground and connections", arm("ground", [
        joint("j1", [0, 0, 1], 5e5, 10.0), box("column", [0, 0, 0.5], "steel", 0.18, 0.18, 0.008),
        joint("j2", [0, 1, 0], 4e5, 9.0), box("upper", [0.6, 0, 0], "steel", 0.12, 0.14, 0.006),
        joint("j3", [0, 1, 0], 2e5, 6.0), box("fore", [0.5, 0, 0], "steel", 0.1, 0.1, 0.005), *wrist()],
        [effect("base_compliance", "base", stiffness_nm_per_rad=9e5), effect("connection_compliance", "j3", stiffness_nm_per_rad=5e5),
         effect("bearing_tilt", "j2", stiffness_nm_per_rad=7e5), effect("extra_mass", "j3", delta_kg=1.5),
         effect("harness_mass", "upper", kg_per_m=1.2), effect("modulus_error", "fore", factor=0.8)]),
        [case("folded", [40, -50, 110, 0, -30, 0], 7.0)]))
    out.append(("layup", arm("layup", [
        joint("j2", [0, 1, 0], 2e5, 5.0), box("upper", [0.8, 0, 0], "layup", 0.12, 0.12, 0.006),
        joint("j3", [0, 1, 0], 1e5, 5.0), pipe("fore", [0.6, 0, 0], "layup", 0.1, 0.005), joint("j4", [1, 0, 0], 3e4, 2.0),
        offset("tool", [0.1, 0.05, 0])]), [case("out", [-10, 35, 20], 4.0)]))
    out.append(("bodies", arm("bodies", [
        joint("j1", [0, 0, 1], 4e5, 2.0, bodies=[body(6.0, (0.02, 0, -0.05), (0.2, 0.2, 0.15))]),
        box("column", [0, 0, 0.4], "aluminium", 0.16, 0.16, 0.008, bodies=[body(3.0, (0.05, 0.02, 0.4), (0.1, 0.1, 0.1))]),
        joint("j2", [0, 1, 0], 2.5e5, 0.5, bodies=[{**body(4.0, (0, 0.08, 0.02), (0.15, 0.2, 0.15)), "rotates": True}]),
        box("upper", [0.7, 0, 0], "aluminium", 0.12, 0.14, 0.006, bodies=[body(2.5, (0.35, 0.05, 0.04), (0.2, 0.06, 0.08))]),
        joint("j3", [0, 1, 0], 1.2e5, 3.0), box("fore", [0.5, 0, 0], "aluminium", 0.1, 0.1, 0.005), *wrist()]),
        [case("up", [15, -60, 95, 20, 30, -15], 5.0, (0.05, 0.01, 0.02), (0.03, 0.02, 0.04))]))
    out.append(("linkage", arm("linkage", [
        joint("j1", [0, 0, 1], 4e5, 8.0), box("column", [0, 0, 0.5], "steel", 0.16, 0.16, 0.008),
        joint("j2", [0, 1, 0], 3e5, 8.0), box("upper", [0.7, 0, 0], "steel", 0.12, 0.12, 0.006),
        joint("j3", [0, 1, 0], 2e5, 5.0), box("fore", [0.6, 0, 0], "steel", 0.1, 0.1, 0.005),
        joint("level", [0, 1, 0], None, 1.5, coupled={"j2": -1, "j3": -1}), offset("hand", [0.15, 0, -0.05], 0.5),
        joint("j4", [0, 0, 1], 2e4, 1.0), offset("tool", [0, 0, -0.1])]), [case("level", [25, -40, 65, 15], 6.0, (0.02, 0.01, -0.05))]))
    out.append(("compliant linkage", arm("compliant linkage", [
        joint("j1", [0, 0, 1], 4e5, 8.0), box("column", [0, 0, 0.5], "steel", 0.16, 0.16, 0.008),
        joint("j2", [0, 1, 0], 3e5, 8.0), box("upper", [0.7, 0, 0], "steel", 0.12, 0.12, 0.006),
        joint("j3", [0, 1, 0], 2e5, 5.0), box("fore", [0.6, 0, 0], "steel", 0.1, 0.1, 0.005),
        joint("level", [0, 1, 0], 5e4, 1.5, coupled={"j2": -1, "j3": -1}), offset("hand", [0.15, 0, -0.05], 0.5),
        joint("j4", [0, 0, 1], 2e4, 1.0), offset("tool", [0, 0, -0.1])]), [case("level", [25, -40, 65, 15], 6.0, (0.02, 0.01, -0.05))]))
    out.append(("driver outboard", arm("driver outboard", [
        joint("j1", [0, 0, 1], 4e5, 8.0), box("column", [0, 0, 0.5], "steel", 0.16, 0.16, 0.008),
        joint("lead", [0, 1, 0], None, 2.0, coupled={"j3": 0.5}), box("upper", [0.5, 0, 0], "steel", 0.1, 0.1, 0.005),
        joint("j2", [0, 1, 0], 1.5e5, 5.0), box("fore", [0.5, 0, 0], "aluminium", 0.1, 0.1, 0.005),
        joint("j3", [0, 1, 0], 6e4, 2.0), offset("hand", [0.1, 0, -0.05], 0.5)]), [case("low", [20, 15, 30], 5.0, (0.02, 0.01, -0.05))]))
    ibeam = {"shape": "i_beam", "width_m": 0.08, "height_m": 0.14, "web_m": 0.008, "flange_m": 0.01}
    bar = {"shape": "rectangular_bar", "width_m": 0.06, "height_m": 0.09}
    rod = {"shape": "round_bar", "diameter_m": 0.08}
    out.append(("bars", arm("bars", [
        joint("j2", [0, 1, 0], 5e5, 4.0), {"type": "link", "name": "upper", "vector_m": [0.6, 0, 0], "material": "steel", "section": bar},
        joint("j3", [0, 1, 0], 2e5, 4.0), {"type": "link", "name": "fore", "vector_m": [0.5, 0, 0], "material": "aluminium", "section": rod},
        joint("j4", [0, 1, 0], 5e4, 2.0), offset("tool", [0.1, 0, 0])]), [case("low", [10, 30, -20], 5.0)]))
    out.append(("I beam in the plane of its web", arm("ibeam", [
        joint("j2", [0, 1, 0], 8e5, 4.0), {"type": "link", "name": "upper", "vector_m": [0.9, 0, 0], "material": "steel", "section": ibeam},
        joint("j3", [0, 1, 0], 2e5, 3.0), box("fore", [0.5, 0, 0], "steel", 0.08, 0.08, 0.004), offset("tool", [0.05, 0, 0])]),
        [case("low", [5, 20], 10.0)]))
    out.append(("hanging, with forces", arm("hanging", [
        joint("j1", [0, 0, 1], 3e5, 6.0), box("column", [0, 0, 0.3], "steel", 0.16, 0.16, 0.008),
        joint("j2", [0, 1, 0], 2e5, 6.0), box("upper", [0.6, 0, 0], "aluminium", 0.12, 0.12, 0.006),
        joint("j3", [0, 1, 0], 1e5, 5.0), box("fore", [0.5, 0, 0], "aluminium", 0.1, 0.1, 0.005), *wrist()], gravity_m_s2=[1.5, -2.0, 9.3]),
        [case("hung", [10, 40, -60, 0, 20, 0], 4.0, tip_force_n=[20.0, -35.0, 50.0], tip_moment_nm=[3.0, -4.0, 2.0])]))
    out.append(("balanced", arm("balanced", [
        geared("j1", [0, 0, 1], 3e5, 60, 6.0), box("column", [0, 0, 0.3], "steel", 0.16, 0.16, 0.008),
        geared("j2", [0, 1, 0], 2e5, 50, 6.0), box("upper", [0.6, 0, 0], "aluminium", 0.12, 0.12, 0.006),
        geared("j3", [0, 1, 0], 1e5, 30, 5.0), box("fore", [0.5, 0, 0], "aluminium", 0.1, 0.1, 0.005), *wrist()],
        [effect("joint_torque", "j3", offset_nm=-45)], springs=[{"name": "balancer", "joint": "j2", "stiffness_nm_per_rad": 90, "free_deg": -80}]),
        [case("out", [10, 10, 20, 0, 20, 0], 4.0, tip_force_n=[20.0, 35.0, 50.0])]))
    return out


def prismatic(name, axis, stiffness, guide=(None, None, None), **more):
    guide = dict(zip(("roll_nm_per_rad", "pitch_nm_per_rad", "yaw_nm_per_rad"), guide))
    return {"type": "prismatic", "name": name, "axis": axis, "stiffness_n_per_m": stiffness, "guide": guide, **more}


def sliding(name, pose, mass=5.0, cg=(0.05, 0.0, 0.0), inertia=(0.01, 0.02, 0.015)):
    out = case(name, [], mass, cg, inertia)
    del out["pose_deg"]
    return {**out, "pose": pose}


def sliding_arms():
    """Arms with prismatic joints; decks of CalculiX have none."""
    gantry = arm("gantry", [
        prismatic("rail", [1, 0, 0], 4e7, (2e5, 3e5, None), mass_kg=14.0, fixed_mass_kg=5.0, bodies=[{**body(6.0, (0, 0.1, 0.05), (0.3, 0.2, 0.1)), "travels": True}]),
        box("bridge", [0, 0.6, 0.1], "aluminium", 0.16, 0.2, 0.008), prismatic("cross", [0, 1, 0], 3e7, (None, 2e5, 1.5e5), mass_kg=6.0),
        box("hanger", [0.05, 0, -0.2], "steel", 0.08, 0.08, 0.004), prismatic("quill", [0, 0, -1], 2e7, (6e4, 8e4, 7e4), moves="ram", mass_kg=3.0),
        offset("spindle", [0, 0, -0.15], 1.0)])
    mixed = arm("arm-on-a-rail", [
        prismatic("rail", [0, 1, 0], None, (3e5, 4e5, 4e5), mass_kg=20.0), joint("j1", [0, 0, 1], 3e5, 9.0, **bearing(5e5)),
        box("column", [0, 0, 0.5], "steel", 0.16, 0.16, 0.008), joint("j2", [0, 1, 0], 2e5, 7.0), box("upper", [0.6, 0, 0], "aluminium", 0.12, 0.12, 0.006),
        geared("j3", [0, 1, 0], 9e4, 40, 5.0), prismatic("boom", [1, 0, 0.2], 5e6, (5e4, 9e4, 9e4), moves="ram", mass_kg=2.5),
        pipe("tube", [0.4, 0, 0.02], "carbon", 0.08, 0.004), joint("j4", [1, 0, 0], 2e4, 1.0), offset("tool", [0.08, 0.02, 0])])
    return [("gantry", gantry, [sliding("middle", {"rail_mm": 700, "cross_mm": -350, "quill_mm": 250})]),
            ("arm on a rail", mixed, [sliding("out", {"rail_mm": -400, "j1_deg": 25, "j2_deg": -30, "j3_deg": 50, "boom_mm": 320, "j4_deg": 40}, 4.0)])]


def random_arm(seed):
    r = random.Random(seed)
    pick = lambda low, high: round(low + (high - low) * r.random(), 4)
    chain, axes = [], [[0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0]]
    for i, axis in enumerate(axes):
        scale = 0.75**i
        more = bearing(round(1e6 * scale * pick(0.7, 1.5))) if r.random() < 0.6 else {}
        name = f"j{i + 1}"
        chain.append(geared(name, axis, round(3e5 * scale * pick(0.6, 1.6)), round(120 * scale), round(10 * scale, 2), **more)
                     if r.random() < 0.6 else joint(name, axis, round(4e5 * scale * pick(0.6, 1.6)), round(9 * scale, 2), **more))
        vector = [0, 0, pick(0.3, 0.5)] if i == 0 else [pick(0.35, 0.7), pick(-0.04, 0.04), pick(-0.05, 0.05)]
        if i in (0, 1, 2):
            side, material = 0.18 * 0.85**i, r.choice(["steel", "aluminium", "carbon"])
            wall = round(side * pick(0.05, 0.09), 4)
            chain.append(box(f"l{i}", vector, material, round(side, 4), round(side * pick(0.8, 1.2), 4), wall)
                         if r.random() < 0.5 else pipe(f"l{i}", vector, material, round(side, 4), wall))
        else:
            chain.append(offset(f"l{i}", [0.08, 0.0, pick(-0.02, 0.02)], pick(0.0, 0.5)))
    pose = [pick(-120, 120), pick(-60, 40), pick(-40, 110), pick(-90, 90), pick(-80, 80), pick(-90, 90)]
    return f"random {seed}", arm(f"random-{seed}", chain), [case("pose", pose, pick(2, 8), (pick(0, 0.1), pick(-0.03, 0.03), 0.02), (0.01, 0.02, 0.015))]


def arms(randoms=3):
    return fixed_arms() + [random_arm(seed) for seed in range(1, 1 + randoms)]
