"""An arm from a compiled model of MuJoCo.

MuJoCo reads MJCF and URDF with their defaults, includes and frames; the compiled model has every body and joint resolved. The arm is
the path from the world to the tip. What hangs on it beside the path (fingers, cables) is lumped: its bodies are carried by the piece
of the path that they hang on, with their joints held at zero.

At zero joint coordinates every frame of an arm file is parallel to the world. So positions, axes and inertias are read there, in
world axes, and poses of the arm are the joint coordinates of MuJoCo in degrees. A joint that follows another one by an equality
constraint stands where the constraint puts it while the others are at zero; a joint that a constraint holds is part of its link.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Set, Union

import numpy as np

from .errors import UsageError

if TYPE_CHECKING:
    import mujoco

#: A vector shorter than this is none [m].
_NOTHING_M = 1e-12


@dataclass
class _Followed:
    """What an equality constraint makes of a joint: its coordinate is ``at + slope * leader`` [rad, m]."""

    at: float
    slope: float
    #: None for a joint that is held
    leader: Optional[int]


def from_mujoco(
    model: mujoco.MjModel,
    tip: str,
    *,
    stiffness_nm_per_rad: Union[None, float, Mapping] = None,
    name: Optional[str] = None,
) -> Dict[str, Any]:
    """An arm file, as a dict, of the path from the world to a body or site of a compiled model.

    Hinges become joints, slides prismatic joints, rigid bodies ``bodies`` of the links between them, and equality constraints of
    two hinges that are linear become ``coupled``. Gravity is the model's. ``provenance`` lists what was lumped, what stayed rigid and
    what was left out (armature, damping, friction, gravity compensation, other constraints, springs of tendons).

    :param model: compiled model, such as ``mujoco.MjModel.from_xml_path("arm.xml")``
    :param tip: name of the body or site at the arm's tip
    :param stiffness_nm_per_rad: stiffness of every hinge, or by joint name [N m/rad]; it goes before the model's own joint stiffness.
        A joint without either is rigid.
    :param name: name of the arm; default: the tip's
    :returns: dict for :func:`armwright.analyze`; torques of a pose equal ``-qfrc_bias`` of MuJoCo at rest
    :raises UsageError: there is no such tip, or the path has a ball or free joint
    """
    return _Reader(model, stiffness_nm_per_rad).arm(tip, name or tip)


class _Reader:
    """A model with its joints at zero, and what is to be said of the arm."""

    def __init__(self, model: mujoco.MjModel, stiffness: Union[None, float, Mapping]):
        import mujoco

        self.mj, self.model, self.stiffness = mujoco, model, stiffness
        self.data = mujoco.MjData(model)
        #: joints that follow another one, but not in proportion
        self.curved: Set[int] = set()
        self.followed = self._constrained()
        for joint in range(model.njnt):
            if self._kind(joint) in ("hinge", "slide"):
                self.data.qpos[model.jnt_qposadr[joint]] = self.followed[joint].at if joint in self.followed else 0.0
        mujoco.mj_kinematics(model, self.data)
        mujoco.mj_comPos(model, self.data)
        self.links = 0
        self.lumped: List[str] = []
        self.rigid: List[str] = []
        self.left_out: List[str] = []

    def arm(self, tip: str, name: str) -> Dict[str, Any]:
        body, tip_m = self._tip(tip)
        path = self._path(body)
        carried = self._carried(path)
        joints = [joint for on_path in path for joint in self._joints(on_path)]
        couplings = self._couplings(joints)
        self._leave_out(carried)
        chain: List[Dict[str, Any]] = []
        at_m, bodies = np.zeros(3), list(carried[0])
        for on_path in path:
            for joint in self._joints(on_path):
                anchor_m = self.data.xanchor[joint].copy()
                chain += self._link(at_m, anchor_m, bodies)
                chain.append(self._joint(joint, couplings))
                at_m, bodies = anchor_m, []
            bodies += carried[on_path]
        chain += self._link(at_m, tip_m, bodies)
        said = {"tip": tip, "lumped": self.lumped, "rigid": self.rigid, "left_out": self.left_out}
        return {
            "name": name,
            "gravity_m_s2": self._gravity(),
            "chain": chain,
            "provenance": {"from": "compiled model of MuJoCo", **said},
        }

    def _name(self, kind: str, index: int) -> str:
        names = {"joint": self.model.joint, "body": self.model.body}
        return names[kind](index).name or f"{kind}{index}"

    def _kind(self, joint: int) -> str:
        return {0: "free", 1: "ball", 2: "slide", 3: "hinge"}[int(self.model.jnt_type[joint])]

    def _tip(self, tip: str):
        """The body of the tip and the tip's place [m]."""
        kinds = self.mj.mjtObj
        body = self.mj.mj_name2id(self.model, kinds.mjOBJ_BODY, tip)
        if body >= 0:
            return body, self.data.xpos[body].copy()
        site = self.mj.mj_name2id(self.model, kinds.mjOBJ_SITE, tip)
        if site >= 0:
            # the kinematics of sites stand with those of bodies
            return int(self.model.site_bodyid[site]), self.data.site_xpos[site].copy()
        bodies = [self._name("body", index) for index in range(1, self.model.nbody)]
        raise UsageError(f"no body or site is called {tip!r}; the bodies are {', '.join(bodies)}")

    def _path(self, body: int) -> List[int]:
        """The bodies from the world, which is left out, to the tip's."""
        path: List[int] = []
        while body:
            path.insert(0, body)
            body = int(self.model.body_parentid[body])
        return path

    def _joints(self, body: int) -> List[int]:
        """Its joints that move; those that a constraint holds are part of the link."""
        first = int(self.model.body_jntadr[body])
        own = range(first, first + int(self.model.body_jntnum[body])) if first >= 0 else range(0)
        return [joint for joint in own if joint not in self.followed or self.followed[joint].leader is not None]

    def _carried(self, path: List[int]) -> Dict[int, List[int]]:
        """The rigid bodies that each body of the path carries, itself among them; what stands on the world carries nothing."""
        carried: Dict[int, List[int]] = {body: [] for body in [0, *path]}
        for body in range(1, self.model.nbody):
            owner = body
            while owner not in carried:
                owner = int(self.model.body_parentid[owner])
            if owner == 0 or self.model.body_mass[body] == 0:
                continue
            if owner != body:
                self.lumped.append(f"{self._name('body', body)} is carried by {self._name('body', owner)}")
            if self.model.body_gravcomp[body] != 0:
                self.left_out.append(f"gravity compensation of {self._name('body', body)}")
            carried[owner].append(body)
        return carried

    def _rigid_body(self, body: int, from_m: np.ndarray) -> Dict[str, Any]:
        turn = self.data.ximat[body].reshape(3, 3)
        inertia = turn @ np.diag(self.model.body_inertia[body]) @ turn.T
        return {
            "mass_kg": float(self.model.body_mass[body]),
            "cg_m": (self.data.xipos[body] - from_m).tolist(),
            # rounding leaves the halves of a product unequal in the last digit
            "inertia_kgm2": (0.5 * (inertia + inertia.T)).tolist(),
        }

    def _link(self, from_m: np.ndarray, to_m: np.ndarray, carried: List[int]) -> List[Dict[str, Any]]:
        """The rigid link between two joints, if it has a length or carries anything."""
        vector_m = to_m - from_m
        if np.linalg.norm(vector_m) < _NOTHING_M:
            vector_m = np.zeros(3)
            if not carried:
                return []
        self.links += 1
        link: Dict[str, Any] = {"type": "link", "name": f"link{self.links}", "vector_m": vector_m.tolist()}
        if carried:
            link["bodies"] = [self._rigid_body(body, from_m) for body in carried]
        return [link]

    def _joint(self, joint: int, couplings: Dict[int, Dict[str, float]]) -> Dict[str, Any]:
        kind, name = self._kind(joint), self._name("joint", joint)
        if kind in ("free", "ball"):
            raise UsageError(f"joint {name!r} on the way to the tip is a {kind} joint: an arm has hinges and slides")
        dof = int(self.model.jnt_dofadr[joint])
        amounts = {"armature": self.model.dof_armature, "damping": self.model.dof_damping, "friction": self.model.dof_frictionloss}
        for what, of_dofs in amounts.items():
            if np.any(of_dofs[dof]):
                self.left_out.append(f"{what} of {name}")
        out: Dict[str, Any] = {"type": "joint", "name": name, "axis": self.data.xaxis[joint].tolist()}
        stiffness = self._stiffness(joint, name, kind)
        if kind == "slide":
            out["type"] = "prismatic"
            out["stiffness_n_per_m"] = stiffness
        else:
            out["stiffness_nm_per_rad"] = stiffness
        if stiffness is None:
            self.rigid.append(name)
        if joint in couplings:
            out["coupled"] = couplings[joint]
        return out

    def _stiffness(self, joint: int, name: str, kind: str) -> Optional[float]:
        stated = self.stiffness
        if isinstance(stated, Mapping):
            stated = stated.get(name)
        elif kind == "slide":
            stated = None
        if stated is not None:
            return float(stated)
        own = float(np.ravel(self.model.jnt_stiffness[joint])[0])
        return own if own > 0 else None

    def _constrained(self) -> Dict[int, _Followed]:
        """The joints that an equality constraint ties to another joint, or holds.

        MuJoCo counts both coordinates from the model's own configuration, ``qpos0``.
        """
        model, out = self.model, {}
        for equality in self._equalities():
            if model.eq_type[equality] != self.mj.mjtEq.mjEQ_JOINT:
                continue
            joint, leader = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
            offset, slope, *higher = [float(c) for c in model.eq_data[equality][:5]]
            at = model.qpos0[model.jnt_qposadr[joint]] + offset
            if leader < 0:
                self.lumped.append(f"joint {self._name('joint', joint)} is held at {at:.6g}")
                out[joint] = _Followed(at, 0.0, None)
            elif any(higher):
                self.curved.add(joint)
            else:
                out[joint] = _Followed(at - slope * model.qpos0[model.jnt_qposadr[leader]], slope, leader)
        return {joint: self._resolved(joint, out) for joint in out}

    def _resolved(self, joint: int, known: Dict[int, _Followed]) -> _Followed:
        """What the joint follows in the end, where its leader follows another joint."""
        own, seen = known[joint], {joint}
        while own.leader is not None and own.leader in known:
            if own.leader in seen:
                raise UsageError(f"joint {self._name('joint', joint)!r} follows itself by equality constraints; remove one of them")
            seen.add(own.leader)
            leader = known[own.leader]
            own = _Followed(own.at + own.slope * leader.at, own.slope * leader.slope, leader.leader)
        return own

    def _couplings(self, joints: List[int]) -> Dict[int, Dict[str, float]]:
        """The joints of the path that follow another one of it, which an arm file can say in proportion only."""
        out = {}
        for joint in joints:
            own = self.followed.get(joint)
            if joint in self.curved or (own is not None and own.leader not in joints):
                raise UsageError(
                    f"joint {self._name('joint', joint)!r} follows no other joint of the path in proportion, which an arm file "
                    "cannot say; remove its equality constraint"
                )
            if own is not None:
                out[joint] = {self._name("joint", own.leader): own.slope}
        return out

    def _equalities(self) -> List[int]:
        """The equality constraints that act from the start."""
        return [equality for equality in range(self.model.neq) if self.model.eq_active0[equality]]

    def _leave_out(self, carried: Dict[int, List[int]]) -> None:
        """Lists constraints and springs of the arm's bodies that an arm file cannot say."""
        model, kinds = self.model, self.mj.mjtEq
        bodies = {body for some in carried.values() for body in some} | set(carried) - {0}
        for equality in self._equalities():
            kind = model.eq_type[equality]
            if kind == kinds.mjEQ_JOINT:
                continue
            ends = [int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])]
            if kind in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
                if model.eq_objtype[equality] == self.mj.mjtObj.mjOBJ_SITE:
                    ends = [int(model.site_bodyid[site]) for site in ends]
                if bodies.isdisjoint(ends):
                    continue
            word = kinds(kind).name.replace("mjEQ_", "").lower()
            self.left_out.append(f"{word} constraint {model.equality(equality).name or equality}")
        for tendon in range(model.ntendon):
            if np.any(model.tendon_stiffness[tendon]):
                self.left_out.append(f"spring of tendon {model.tendon(tendon).name or tendon}")

    def _gravity(self) -> Union[float, List[float]]:
        off = self.model.opt.disableflags & self.mj.mjtDisableBit.mjDSBL_GRAVITY
        gravity = np.zeros(3) if off else self.model.opt.gravity
        if gravity[0] == 0 and gravity[1] == 0 and gravity[2] <= 0:
            return float(-gravity[2])
        return gravity.tolist()
