"""Arms from compiled models of MuJoCo: torques of gravity and of a force at the tip equal MuJoCo's within 1e-6 N m.

Both programs compute the same rigid-body statics in double precision; the tolerance leaves room for the length of the chains alone.
"""

import armwright
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

POSES = 50
TOLERANCE_NM = 1e-6

BRANCHED = """
<mujoco model="branched">
  <compiler angle="degree" autolimits="true"/>
  <option gravity="1 -2 -9.5"/>
  <worldbody>
    <body name="pillar" pos="3 0 0"><geom type="sphere" size="0.2" mass="40"/></body>
    <body name="base" pos="0.1 0.2 0.3" euler="10 20 30">
      <geom type="box" size="0.1 0.1 0.1" mass="8"/>
      <body name="turn" pos="0 0 0.2">
        <joint name="j1" axis="0 0 1" ref="15" stiffness="9000" armature="0.1" damping="3"/>
        <inertial pos="0.02 0.01 0.1" quat="0.9 0.1 0.3 0.2" mass="6" diaginertia="0.05 0.04 0.03"/>
        <body name="upper" pos="0.1 0 0.25" quat="0.7 0.1 0.6 0.2">
          <joint name="j2" axis="0.2 1 0.1" pos="0.01 0.02 0"/>
          <joint name="j3" axis="1 0 0.3" pos="0.3 0 0"/>
          <geom type="capsule" fromto="0 0 0 0.5 0.1 0" size="0.04" mass="5"/>
          <body name="cable" pos="0.2 0.1 0">
            <joint name="swing" axis="0 1 0"/>
            <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.01" mass="0.7"/>
          </body>
          <body name="hand" pos="0.5 0.1 0">
            <joint name="j4" axis="0 0 1"/>
            <geom type="box" size="0.05 0.03 0.02" mass="1.5"/>
            <body name="finger" pos="0.05 0 0"><geom type="sphere" size="0.02" mass="0.2"/></body>
            <site name="tool" pos="0.1 0.02 -0.03"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

URDF = """
<robot name="two">
  <link name="world"/>
  <link name="arm">
    <inertial><origin xyz="0.2 0.01 0" rpy="0.3 0.2 0.1"/><mass value="4"/>
      <inertia ixx="0.02" ixy="0.002" ixz="0.001" iyy="0.05" iyz="0.003" izz="0.06"/></inertial>
  </link>
  <link name="fore">
    <inertial><origin xyz="0.1 0 0.02" rpy="0 0 0"/><mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
  </link>
  <joint name="a" type="revolute"><parent link="world"/><child link="arm"/>
    <origin xyz="0 0 0.4" rpy="0.1 0.2 0.3"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="b" type="continuous"><parent link="arm"/><child link="fore"/>
    <origin xyz="0.4 0 0" rpy="1.2 0 0"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def serial(seed):
    """A chain of up to eight hinges with random frames, axes, centres and inertias."""
    dice = np.random.default_rng(seed)

    def words(numbers):
        return " ".join(f"{number:.6f}" for number in numbers)

    count = int(dice.integers(2, 9))
    text = ""
    for joint in range(count):
        heads = dice.uniform(0.5, 1.0, 3) * dice.uniform(0.5, 5)
        text += (
            f'<body name="b{joint}" pos="{words(dice.uniform(-0.4, 0.4, 3))}" quat="{words(dice.normal(size=4))}">'
            f'<joint name="j{joint}" axis="{words(dice.normal(size=3))}" pos="{words(dice.uniform(-0.1, 0.1, 3))}"/>'
            f'<inertial pos="{words(dice.uniform(-0.2, 0.2, 3))}" quat="{words(dice.normal(size=4))}" '
            f'mass="{dice.uniform(0.2, 12):.6f}" diaginertia="{words(heads * 0.01)}"/>'
        )
    return f"<mujoco><worldbody>{text}{'</body>' * count}</worldbody></mujoco>", f"b{count - 1}"


MODELS = {"branched": (BRANCHED, "tool"), "urdf": (URDF, "fore"), **{f"random {n}": serial(n) for n in range(10)}}


def held(model, names, pose):
    """MuJoCo at rest in a pose of the arm; every other joint at zero."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0
    for name, angle in zip(names, pose):
        data.qpos[model.joint(name).qposadr[0]] = angle
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("which", MODELS)
def test_torques_equal_mujocos(which):
    text, tip = MODELS[which]
    model = mujoco.MjModel.from_xml_string(text)
    arm = armwright.from_mujoco(model, tip)
    names = armwright.driven_joints(arm)
    dice = np.random.default_rng(7)
    poses = dice.uniform(-np.pi, np.pi, (POSES, len(names)))
    forces = dice.uniform(-30, 30, (POSES, 3))
    cases = [{"pose_deg": np.degrees(pose), "tip_force_n": force} for pose, force in zip(poses, forces)]
    solved = armwright.analyze(arm, cases=cases, modes=1)
    worst = 0.0
    for pose, force, answer in zip(poses, forces, solved):
        data = held(model, names, pose)
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, tip)
        site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tip)
        point, of = (data.xpos[body], body) if body >= 0 else (data.site_xpos[site], model.site_bodyid[site])
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, jacobian, None, point, of)
        theirs = -data.qfrc_bias + jacobian.T @ force
        for name in names:
            worst = max(worst, abs(answer["joint_torque_nm"][name] - theirs[model.joint(name).dofadr[0]]))
    print(f"{which}: {len(names)} joints, {POSES} poses, largest difference {worst:.1e} N m")
    assert worst < TOLERANCE_NM


def test_what_the_model_says_of_joints_is_taken_or_told():
    model = mujoco.MjModel.from_xml_string(BRANCHED)
    arm = armwright.from_mujoco(model, "tool", stiffness_nm_per_rad={"j2": 5e4})
    stiffness = {e["name"]: e["stiffness_nm_per_rad"] for e in arm["chain"] if e["type"] == "joint"}
    assert stiffness == {"j1": 9000.0, "j2": 5e4, "j3": None, "j4": None}
    said = arm["provenance"]
    assert said["rigid"] == ["j3", "j4"]
    assert said["left_out"] == ["armature of j1", "damping of j1"]
    assert said["lumped"] == ["cable is carried by upper", "finger is carried by hand"]
    # the pillar stands on the world and loads nothing
    weighed = sum(body["mass_kg"] for element in arm["chain"] for body in element.get("bodies", []))
    assert weighed == pytest.approx(8 + 6 + 5 + 0.7 + 1.5 + 0.2, abs=1e-9)


def test_a_spring_of_a_joint_yields():
    model = mujoco.MjModel.from_xml_string(BRANCHED)
    arm = armwright.from_mujoco(model, "tool")
    solved = armwright.analyze(arm)
    assert np.linalg.norm(solved["tip_displacement_m"]) > 0
    assert [share["element"] for share in solved["shares"] if np.linalg.norm(share["tip_displacement_m"]) > 0] == ["j1"]


def test_a_mimicking_hinge_is_coupled():
    text = """<mujoco><worldbody><body name="a"><joint name="p" axis="0 1 0"/><geom size="0.1" mass="1" pos="0.2 0 0"/>
      <body name="b" pos="0.5 0 0"><joint name="q" axis="0 1 0"/><geom size="0.1" mass="2" pos="0.3 0 0"/></body></body></worldbody>
      <equality><joint joint1="q" joint2="p" polycoef="0 -1 0 0 0"/></equality></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    arm = armwright.from_mujoco(model, "b")
    assert armwright.driven_joints(arm) == ["p"]
    angle = 0.4
    torque = armwright.analyze(arm, [np.degrees(angle)])["joint_torque_nm"]["p"]
    data = held(model, ["p", "q"], [angle, -angle])
    # the driven joint bears what the passive one hands on, times the coupling's factor
    assert torque == pytest.approx(-data.qfrc_bias[0] + data.qfrc_bias[1], abs=TOLERANCE_NM)


def test_constraints_count_from_the_models_own_configuration():
    text = """<mujoco><worldbody><body name="a"><joint name="p" axis="0 1 0" ref="20"/><geom size="0.1" mass="1" pos="0.2 0 0"/>
      <body name="b" pos="0.5 0 0"><joint name="q" axis="0 1 0.2" ref="-10"/><geom size="0.1" mass="2" pos="0.3 0 0"/>
      <body name="c" pos="0.4 0 0"><joint name="r" axis="0 0.3 1"/><geom size="0.1" mass="3" pos="0.1 0.1 0"/>
      <body name="d" pos="0.3 0 0"><joint name="s" axis="1 1 0"/><geom size="0.1" mass="1.5" pos="0.2 0 0.1"/>
      </body></body></body></body></worldbody><equality>
      <joint joint1="q" joint2="p" polycoef="0.3 -0.8 0 0 0"/><joint joint1="s" joint2="q" polycoef="-0.1 0.5 0 0 0"/>
      <joint joint1="r" polycoef="0.7 0 0 0 0"/><joint joint1="r" joint2="p" active="false"/>
      <connect body1="d" body2="a" anchor="0 0 0"/></equality></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    arm = armwright.from_mujoco(model, "d")
    assert armwright.driven_joints(arm) == ["p"]
    assert arm["provenance"]["lumped"] == ["joint r is held at 0.7 rad"]
    assert arm["provenance"]["left_out"] == ["connect constraint 4"]
    coupled = {e["name"]: e.get("coupled") for e in arm["chain"] if e["type"] == "joint"}
    assert coupled == {"p": None, "q": {"p": pytest.approx(-0.8)}, "s": {"p": pytest.approx(-0.4)}}
    for p in (-0.9, 0.0, 0.4):
        q = np.radians(-10) + 0.3 - 0.8 * (p - np.radians(20))
        s = -0.1 + 0.5 * (q - np.radians(-10))
        data = held(model, ["p", "q", "r", "s"], [p, q, 0.7, s])
        torque = armwright.analyze(arm, [np.degrees(p)])["joint_torque_nm"]["p"]
        of = {name: -data.qfrc_bias[model.joint(name).dofadr[0]] for name in "pqrs"}
        assert torque == pytest.approx(of["p"] - 0.8 * of["q"] - 0.4 * of["s"], abs=TOLERANCE_NM)


def test_what_follows_a_joint_of_the_path_stands_where_it_is_put_and_constraints_can_be_off():
    text = """<mujoco>{option}<worldbody><body name="a"><joint name="p" axis="0 1 0"/><geom size="0.1" mass="1" pos="0.2 0 0"/>
      <body name="finger" pos="0.3 0 0"><joint name="f" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/></body>
      <body name="b" pos="0.5 0 0"><joint name="q" axis="0 1 0"/><geom size="0.1" mass="3" pos="0.1 0 0"/></body></body></worldbody>
      <tendon><fixed name="belt" stiffness="100"><joint joint="q" coef="1"/></fixed></tendon>
      <equality><joint joint1="f" joint2="p" polycoef="0.05 0.1 0.3 0 0"/><joint joint1="q" joint2="p" polycoef="0.2 0 0 0 0"/>
      </equality></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text.format(option=""))
    arm = armwright.from_mujoco(model, "b")
    assert armwright.driven_joints(arm) == ["p"]
    said = arm["provenance"]
    assert said["lumped"] == ["finger is carried by a", "joint q is held at 0.2 rad"]
    assert said["left_out"] == ["motion of f with p", "spring of tendon belt"]
    data = held(model, ["p", "f", "q"], [0.0, 0.05, 0.2])
    torque = armwright.analyze(arm, [0.0])["joint_torque_nm"]["p"]
    assert torque == pytest.approx(-data.qfrc_bias[0], abs=TOLERANCE_NM)
    off = mujoco.MjModel.from_xml_string(text.format(option='<option><flag equality="disable"/></option>'))
    assert armwright.driven_joints(armwright.from_mujoco(off, "b")) == ["p", "q"]


def test_what_no_arm_can_be_is_refused():
    free = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body name="a"><freejoint/><geom size="0.1" mass="1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(armwright.UsageError, match="free joint"):
        armwright.from_mujoco(free, "a")
    with pytest.raises(armwright.UsageError, match="the bodies are a"):
        armwright.from_mujoco(free, "b")
    pair = """<mujoco><worldbody><body name="a"><joint name="p" axis="0 1 0"/><geom size="0.1" mass="1"/><body name="b">
      <joint name="q" axis="0 1 0"/><geom size="0.1" mass="1"/></body></body></worldbody><equality>{}</equality></mujoco>"""
    for ties, words in (
        ('<joint joint1="q" joint2="p" polycoef="0 1 1 0 0"/>', "in proportion"),
        ('<joint joint1="q" joint2="p"/><joint joint1="p" joint2="q"/>', "follows itself"),
        ('<joint joint1="q" joint2="p"/><joint joint1="q"/>', "2 equality constraints"),
    ):
        with pytest.raises(armwright.UsageError, match=words):
            armwright.from_mujoco(mujoco.MjModel.from_xml_string(pair.format(ties)), "b")
