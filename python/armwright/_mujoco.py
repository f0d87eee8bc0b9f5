"""An arm from a compiled model of MuJoCo.

MuJoCo reads MJCF and URDF with their defaults, includes and frames; the compiled model has every body and joint resolved. The arm is
the path from the world to the tip. What hangs on it beside the path (fingers, cables) is lumped: its bodies are carried by the piece
of the path that they hang on, with their joints held where they are when the joints of the path are at zero.

At zero joint coordinates every frame of an arm file is parallel to the world. So positions, axes and inertias are read there, in
world axes, and poses of the arm are the joint coordinates of MuJoCo in degrees. A joint that follows another one by an equality
constraint stands where the constraint puts it while the others are at zero; a joint that a constraint holds is part of its link.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple, Union

import numpy as np

from .errors import UsageError

if TYPE_CHECKING:
    import mujoco

#: A vector shorter than this is none [m].
_NOTHING_M = 1e-12


#: Joint that another one follows (None: it is held), and by how much per unit [-].
_Led = Tuple[Optional[int], float]


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
    what was left out (armature, damping, friction, gravity compensation, other constraints, tendons, fingers that move with the arm).

    :param model: compiled model, such as ``mujoco.MjModel.from_xml_path("arm.xml")``
    :param tip: name of the body or site at the arm's tip
    :param stiffness_nm_per_rad: stiffness of every hinge, or by joint name [N m/rad]; it goes before the model's own joint stiffness.
        A joint without either is rigid.
    :param name: name of the arm; default: the tip's
    :returns: dict for :func:`armwright.analyze`; torques of a pose equal ``-qfrc_bias`` of MuJoCo at rest
    :raises UsageError: there is no such tip, the path has a ball or free joint, or a joint of the path follows another one in a way
        that an arm file cannot say
    """
    return _Reader(model, stiffness_nm_per_rad).arm(tip, name or tip)


class _Reader:
    """A model with its joints at zero, and what is to be said of the arm."""

    def __init__(self, model: mujoco.MjModel, stiffness: Union[None, float, Mapping]):
        import mujoco

        self.mj, self.model, self.stiffness = mujoco, model, stiffness
        self.data = mujoco.MjData(model)
        #: the equality constraints that tie each joint to another one, or hold it
        self.tied: Dict[int, List[int]] = {}
        for equality in self._equalities():
            if model.eq_type[equality] == mujoco.mjtEq.mjEQ_JOINT:
                self.tied.setdefault(int(model.eq_obj1id[equality]), []).append(equality)
        for joint in range(model.njnt):
            if self._kind(joint) in ("hinge", "slide"):
                self.data.qpos[model.jnt_qposadr[joint]] = self._standing(joint)
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
        of_path = [joint for on_path in path for joint in self._joints(on_path)]
        led = {joint: self._led(joint) for joint in of_path}
        couplings = self._couplings(led)
        self._leave_out(path, of_path)
        chain: List[Dict[str, Any]] = []
        at_m, bodies = np.zeros(3), list(carried[0])
        for on_path in path:
            for joint in self._joints(on_path):
                own = led[joint]
                if own is not None and own[0] is None:
                    self._say_held(joint)
                    continue
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

    def _joints(self, body: int) -> range:
        first = int(self.model.body_jntadr[body])
        return range(first, first + int(self.model.body_jntnum[body])) if first >= 0 else range(0)

    def _owner(self, body: int, path: List[int]) -> int:
        """The body of the path that a body hangs on, or 0, the world."""
        while body not in path and body:
            body = int(self.model.body_parentid[body])
        return body

    def _carried(self, path: List[int]) -> Dict[int, List[int]]:
        """The rigid bodies that each body of the path carries, itself among them; what stands on the world carries nothing."""
        carried: Dict[int, List[int]] = {body: [] for body in [0, *path]}
        for body in range(1, self.model.nbody):
            owner = self._owner(body, path)
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

    def _equalities(self) -> List[int]:
        """The equality constraints that act from the start."""
        flags = self.mj.mjtDisableBit
        if self.model.opt.disableflags & (flags.mjDSBL_CONSTRAINT | flags.mjDSBL_EQUALITY):
            return []
        return [equality for equality in range(self.model.neq) if self.model.eq_active0[equality]]

    def _tie(self, equality: int) -> Tuple[int, List[float]]:
        """The leader of a constraint between joints, negative if there is none, and the coefficients of its polynomial.

        The coordinates of both joints are counted from the model's own configuration, ``qpos0``.
        """
        return int(self.model.eq_obj2id[equality]), [float(c) for c in self.model.eq_data[equality][:5]]

    def _own(self, joint: int) -> float:
        return float(self.model.qpos0[self.model.jnt_qposadr[joint]])

    def _standing(self, joint: int, followers: Tuple[int, ...] = ()) -> float:
        """The coordinate of a joint while all joints that follow no other one are at zero [rad, m]."""
        if joint not in self.tied or joint in followers:
            return 0.0
        leader, coefficients = self._tie(self.tied[joint][0])
        beyond = self._standing(leader, (*followers, joint)) - self._own(leader) if leader >= 0 else 0.0
        return self._own(joint) + sum(c * beyond**power for power, c in enumerate(coefficients))

    def _led(self, joint: int, followers: Tuple[int, ...] = ()) -> Optional[_Led]:
        """What a joint follows in the end, where its leader follows another one; None for a joint that is driven."""
        if joint not in self.tied:
            return None
        name = self._name("joint", joint)
        if joint in followers:
            raise UsageError(f"joint {name!r} follows itself by equality constraints; remove one of them")
        if len(self.tied[joint]) > 1:
            raise UsageError(f"joint {name!r} has {len(self.tied[joint])} equality constraints; remove all but one")
        leader, (_, slope, *higher) = self._tie(self.tied[joint][0])
        if leader < 0:
            return None, 0.0
        end, factor = self._led(leader, (*followers, joint)) or (leader, 1.0)
        if end is None or not (slope or any(higher)):
            return None, 0.0
        if any(higher):
            raise self._not_proportional(joint)
        return end, slope * factor

    def _not_proportional(self, joint: int) -> UsageError:
        return UsageError(
            f"joint {self._name('joint', joint)!r} follows no other hinge of the path in proportion, which an arm file cannot say; "
            "remove its equality constraint"
        )

    def _say_held(self, joint: int) -> None:
        unit = "m" if self._kind(joint) == "slide" else "rad"
        self.lumped.append(f"joint {self._name('joint', joint)} is held at {self._standing(joint):.6g} {unit}")

    def _couplings(self, led: Dict[int, Optional[_Led]]) -> Dict[int, Dict[str, float]]:
        """The joints of the path that follow another one of it."""
        out: Dict[int, Dict[str, float]] = {}
        for joint, own in led.items():
            if own is None or own[0] is None:
                continue
            leader, factor = own
            if leader not in led or {self._kind(joint), self._kind(leader)} != {"hinge"}:
                raise self._not_proportional(joint)
            out[joint] = {self._name("joint", leader): factor}
        return out

    def _leave_out(self, path: List[int], joints: List[int]) -> None:
        """Lists constraints and tendons of the arm that an arm file cannot say."""
        model, kinds, objects = self.model, self.mj.mjtEq, self.mj.mjtObj
        is_ours = [bool(self._owner(body, path)) for body in range(model.nbody)]
        # sites are the ends of some constraints since MuJoCo 3.2.3
        types = getattr(model, "eq_objtype", None)
        for equality in self._equalities():
            # an enumeration is compared with its own kind: `in` finds no number of NumPy
            kind = kinds(int(model.eq_type[equality]))
            ends = [int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])]
            if kind == kinds.mjEQ_JOINT:
                continue
            if kind in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
                if types is not None and types[equality] == objects.mjOBJ_SITE:
                    ends = [int(model.site_bodyid[site]) for site in ends]
                bodies = [body for body in ends if body >= 0]
            elif kind == kinds.mjEQ_TENDON:
                bodies = [body for tendon in ends if tendon >= 0 for body in self._of_tendon(tendon)]
            else:
                # of a kind that this package does not know: it may be the arm's
                bodies = path
            if any(is_ours[body] for body in bodies):
                word = kind.name.replace("mjEQ_", "").lower()
                self.left_out.append(f"{word} constraint {model.equality(equality).name or equality}")
        for joint in self.tied:
            leader = self._leader_on(joint, joints)
            if joint not in joints and leader is not None and is_ours[model.jnt_bodyid[joint]]:
                self.left_out.append(f"motion of {self._name('joint', joint)} with {self._name('joint', leader)}")
        amounts = {"spring": model.tendon_stiffness, "damping": model.tendon_damping, "friction": model.tendon_frictionloss}
        for tendon in range(model.ntendon):
            acts = [what for what, of_tendons in amounts.items() if np.any(of_tendons[tendon])]
            if acts and any(is_ours[body] for body in self._of_tendon(tendon)):
                self.left_out.append(f"{', '.join(acts)} of tendon {model.tendon(tendon).name or tendon}")

    def _leader_on(self, joint: int, joints: List[int]) -> Optional[int]:
        """The joint of ``joints`` with which a joint moves, if need be by way of others; None if there is none."""
        seen: List[int] = []
        while joint in self.tied and joint not in seen:
            seen.append(joint)
            leader, coefficients = self._tie(self.tied[joint][0])
            if leader < 0 or not any(coefficients[1:]):
                return None
            if leader in joints:
                return leader
            joint = leader
        return None

    def _of_tendon(self, tendon: int) -> List[int]:
        """The bodies that a tendon runs over or whose joints it couples."""
        model, wraps = self.model, self.mj.mjtWrap
        first = int(model.tendon_adr[tendon])
        out = []
        for wrap in range(first, first + int(model.tendon_num[tendon])):
            kind, own = wraps(int(model.wrap_type[wrap])), int(model.wrap_objid[wrap])
            if kind == wraps.mjWRAP_JOINT:
                out.append(int(model.jnt_bodyid[own]))
            elif kind == wraps.mjWRAP_SITE:
                out.append(int(model.site_bodyid[own]))
            elif kind in (wraps.mjWRAP_SPHERE, wraps.mjWRAP_CYLINDER):
                out.append(int(model.geom_bodyid[own]))
        return out

    def _gravity(self) -> Union[float, List[float]]:
        off = self.model.opt.disableflags & self.mj.mjtDisableBit.mjDSBL_GRAVITY
        gravity = np.zeros(3) if off else self.model.opt.gravity
        if gravity[0] == 0 and gravity[1] == 0 and gravity[2] <= 0:
            return float(-gravity[2])
        return gravity.tolist()
