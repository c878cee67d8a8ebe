"""The model: an arm's laws, the statics of its rod, and its effects."""
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from . import _softarm
from ._arm import Arm, gravity_of, handle_of
from ._common import Floats, Progress, Words, numbers, pandas, plain_dict, progress_of, table, warn, whole_of, words_of

_OUTCOMES = ("ok", "no_laws", "no_equilibrium")


class Jacobians:
    """Derivatives of places by what they follow from. Arrays, with n instants, b bodies and p points of the backbone:

    ``bodies_by_inputs`` (n, b, 3, inputs), m per Pa, N or rad;
    ``bodies_by_payload`` (n, b, 3), m/kg;
    ``bodies_by_gravity`` (n, b, 3, 3), m per m/s²: the last axis is that of gravity;
    ``bodies_by_constants`` (n, b, 3, constants), m per unit of ``constants``;
    ``points_by_...``: the same of the backbone, (n, p, 3, ...).

    NaN where there is no shape. They are of the bodies as they sit at zero input: where a length is a constant, the bodies
    keep their fraction of it.
    """

    def __init__(self, raw: Dict[str, Any], bodies: int, inputs: List[str], constants: List[str]) -> None:
        self.inputs = inputs
        self.constants = constants
        for name in ("inputs", "payload", "gravity", "constants"):
            by = raw["by_" + name]
            setattr(self, "bodies_by_" + name, by[:, :bodies])
            setattr(self, "points_by_" + name, by[:, bodies:])

    def to_dict(self) -> Dict[str, Any]:
        """All arrays, as lists; None for NaN."""
        return plain_dict(vars(self))

    bodies_by_inputs: Floats
    bodies_by_payload: Floats
    bodies_by_gravity: Floats
    bodies_by_constants: Floats
    points_by_inputs: Floats
    points_by_payload: Floats
    points_by_gravity: Floats
    points_by_constants: Floats


class Shapes:
    """Shapes of an arm, in the rod's base frame (z along the backbone at its base). n instants, p points, b bodies, s segments.

    ``arclength_m`` (p,): of the points, from the base at zero input; ``p_base_m`` (n, p, 3); ``q_base_xyzw`` (n, p, 4): the
    section, z along the tangent; ``curvature_per_m`` (n, p, 3): bending about the section's x and y, twist;
    ``force_base_n``, ``moment_base_nm`` (n, p, 3): inside the rod; ``bodies_p_base_m``, ``bodies_tangent_base`` (n, b, 3);
    ``M0_nm``, ``phi_rad``, ``EI_nm2``, ``L_m`` (n, s): what the laws make of the inputs, as effects on inputs leave them.

    ``status`` (n,): "ok", "no_laws" (the laws have no value at these inputs) or "no_equilibrium"; there, floats are NaN.
    ``jacobians``: :class:`Jacobians` if asked for, else None; ``body_names``, ``segment_names``: of the axes b and s.
    """

    def __init__(self, raw: Dict[str, Any], arclength_m: Floats, arm: Arm, constants: List[str]) -> None:
        outcome = raw.pop("outcome")
        for array in raw.values():
            array[outcome != 0] = np.nan
        self.status = np.array(_OUTCOMES)[outcome]
        self.arclength_m = arclength_m
        self.body_names = [body.name for body in arm.bodies]
        self.segment_names = [segment.name for segment in arm.segments]
        self.jacobians: Optional[Jacobians] = None
        if "by_inputs" in raw:
            self.jacobians = Jacobians(raw, len(self.body_names), [one.name for one in arm.inputs], constants)
        for name in ("p_base_m", "q_base_xyzw", "curvature_per_m", "force_base_n", "moment_base_nm", "bodies_p_base_m",
                     "bodies_tangent_base", "M0_nm", "phi_rad", "EI_nm2", "L_m"):
            setattr(self, name, raw[name])

    status: Words
    p_base_m: Floats
    q_base_xyzw: Floats
    curvature_per_m: Floats
    force_base_n: Floats
    moment_base_nm: Floats
    bodies_p_base_m: Floats
    bodies_tangent_base: Floats
    M0_nm: Floats
    phi_rad: Floats
    EI_nm2: Floats
    L_m: Floats

    def __len__(self) -> int:
        return len(self.status)

    def to_dict(self) -> Dict[str, Any]:
        """All but the Jacobians, as lists; None for NaN."""
        return plain_dict({name: value for name, value in vars(self).items() if name != "jacobians"})

    def to_pandas(self) -> Any:
        """A DataFrame with a row per instant: ``status``, ``ring_1_x_m`` ..., ``segment_1_M0_nm``, ``segment_1_phi_rad`` ..."""
        columns: Dict[str, Any] = {"status": self.status}
        for k, body in enumerate(self.body_names):
            for axis, letter in enumerate("xyz"):
                columns[f"{body}_{letter}_m"] = self.bodies_p_base_m[:, k, axis]
        for k, segment in enumerate(self.segment_names):
            for name in ("M0_nm", "phi_rad", "EI_nm2", "L_m"):
                columns[f"{segment}_{name}"] = getattr(self, name)[:, k]
        return pandas().DataFrame(columns)


class Model:
    """An arm's shape at rest from its inputs and payload: the arm file's laws, the exact statics of its rod, and the effects of
    the file (``diagnose`` writes them into arm_extended.yaml), as :func:`estimate` has them.

    A wall has done all of its creep. Use one from one thread at a time, or several; Python's lock is released while it works.
    """

    def __init__(self, arm: Arm, *, points: int = 41, constants: Sequence[str] = ()) -> None:
        """``points``: evenly spaced places of the backbone, base and tip among them.

        ``constants``: names of those that ``Jacobians.bodies_by_constants`` is by. Raises ValueError for a wrong name. A
        SoftarmWarning says which effects are in the model, and which cannot be.
        """
        handle = handle_of(arm)
        points = whole_of("points", points, 2, 1001)
        self.arm = arm
        self.constants = words_of("constants", constants)
        self.arclength_m = np.asarray(np.linspace(0.0, arm.length_m, points), dtype=np.float64)
        self._handle = _softarm.ModelHandle(handle, [float(s) for s in self.arclength_m], self.constants)
        for note in self.notes:
            warn(note)

    @property
    def notes(self) -> List[str]:
        """Which effects of the arm file are in the model, and which cannot be and why, a line each."""
        return self._handle.notes()

    def solve(self, inputs: Any = None, payload_kg: Any = 0.0, *, gravity_base_m_s2: Any = None, stamp_s: Any = None,
              jacobians: bool = False, progress: Optional[Progress] = None) -> Shapes:
        """Shapes at n instants.

        ``inputs``: {name: number or (n,)} (names left out are 0), or an array (n, inputs of the arm); gauge Pa, Pa below
        ambient, N, rad. ``payload_kg``: a number or (n,). ``gravity_base_m_s2``: (3,) or (n, 3), in the rod's base frame;
        by default that of the arm file with its base, or, where the base is a measured body, as if that body's axes were the
        mocap's.

        Every instant is solved from nothing: the order does not matter, and effects remember nothing. With ``stamp_s`` (n,) s,
        increasing, the instants are one trial: effects remember those before (hysteresis, lag, creep), and after 0.5 s without
        an instant are at rest again. ``bodies_p_base_m`` is where motion capture sees the bodies.

        ``jacobians``: also :class:`Jacobians`; with effects as differences of whole solutions, right to a thousandth, and of
        instants that are not a trial. ``progress``: called with (share done, what is being done).

        Raises ValueError for a wrong name or shape, NaN or infinity, stamps that do not increase, or a negative payload.
        """
        names = [one.name for one in self.arm.inputs]
        payload = numbers("payload_kg", payload_kg)
        gravity = gravity_of(self.arm, None) if gravity_base_m_s2 is None else numbers("gravity_base_m_s2", gravity_base_m_s2)
        stamps = None if stamp_s is None else np.atleast_1d(numbers("stamp_s", stamp_s))
        if stamps is not None and jacobians:
            raise ValueError("jacobians: are of single instants; leave stamp_s out")
        count = (payload.shape[0] if payload.ndim == 1 else gravity.shape[0] if gravity.ndim == 2 else
                 None if stamps is None else stamps.shape[0])
        array = table({} if inputs is None else inputs, names, count if inputs is None or isinstance(inputs, dict) else None)
        for i, name in enumerate(names):
            column = array[:, i]
            if not np.isfinite(column).all():
                raise ValueError(f"inputs['{name}']: {column[~np.isfinite(column)][0]}; must be finite")
        if count is not None and array.shape[0] == 1:
            array = np.repeat(array, count, axis=0)
        rows = array.shape[0]
        payload = np.full(rows, payload) if payload.ndim == 0 else payload
        gravity = np.tile(gravity, (rows, 1)) if gravity.ndim == 1 else gravity
        raw = self._handle.solve(array, payload, gravity, stamps, bool(jacobians), progress_of(progress))
        return Shapes(raw, self.arclength_m, self.arm, self.constants)
