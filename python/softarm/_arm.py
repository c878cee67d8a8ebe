"""Arm files."""
import os
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

import numpy as np

from . import _softarm
from ._common import Floats, Path, folders, numbers, path_of, text_of, wrong


class Constant(NamedTuple):
    """A number of the arm's laws, as ``identify`` may fit it.

    ``value``, ``low`` and ``high`` are in ``unit`` (SI). Where ``stated`` is false the arm file does not have it, and it acts
    as 0.
    """

    name: str
    value: float
    unit: str
    low: float
    high: float
    stated: bool


class Body(NamedTuple):
    """A body that motion capture sees: ``kind`` is "ring" or "skin_marker"; ``arclength_m`` from the base at zero input;
    ``orientation_usable``: whether its tangent counts; ``position_sd_m``: noise of a coordinate."""

    name: str
    kind: str
    arclength_m: float
    orientation_usable: bool
    position_sd_m: float


class Input(NamedTuple):
    """What drives the arm: ``kind`` is "pressure", "vacuum", "tension" or "angle"; ``topic`` where it is recorded.

    ``unit`` is that of all arrays of this package: gauge Pa for pressures, Pa below ambient for a vacuum, N, rad.
    """

    name: str
    kind: str
    unit: str
    topic: str


class Segment(NamedTuple):
    """A stretch of the arm: ``length_m`` at zero input, ``mass_kg``, ``diameter_m``; ``inputs`` are the names of those that drive it."""

    name: str
    length_m: float
    mass_kg: float
    diameter_m: float
    inputs: List[str]


class EffectsCorrelations(NamedTuple):
    """How the errors of the effects' numbers go together.

    ``names``: of the p numbers that have a standard deviation, in the order of the file and as it calls them: "creep.share",
    and "marker_slip.2.x_m" of the second of several; ``sd`` (p,): their standard deviations, each in the unit of its name
    (SI; one without a unit has none); ``matrix`` (p, p): their correlations from -1 to 1, without a unit, 1 on the diagonal, 0
    where the file gives none. ``matrix * numpy.outer(sd, sd)`` is their covariance.
    """

    names: List[str]
    sd: Floats
    matrix: Floats


class Arm:
    """An arm, as its file describes it. It does not change: ``with_constants`` gives another arm.

    Get one by :func:`load_arm`, :func:`parse_arm`, ``Identification.arm`` or ``Diagnosis.extended_arm``.
    """

    def __init__(self, handle: "_softarm.ArmHandle") -> None:
        self._handle = handle

    def __repr__(self) -> str:
        return f"<softarm.Arm {self.name}: {len(self.segments)} segments, {len(self.bodies)} bodies>"

    @property
    def name(self) -> str:
        """As the file has it."""
        return self._handle.name

    @property
    def source(self) -> str:
        """The path of the file that it was read from, or what :func:`parse_arm` was told."""
        return self._handle.source

    @property
    def text(self) -> str:
        """The arm file, YAML: what ``save`` writes. Comments, order and units are those of the file that was loaded."""
        return self._handle.text

    @property
    def length_m(self) -> float:
        """Backbone length of all segments at zero input."""
        return self._handle.length_m

    @property
    def segments(self) -> List[Segment]:
        """From base to tip."""
        return [Segment(**one) for one in self._handle.segments()]

    @property
    def bodies(self) -> List[Body]:
        """From base to tip: the order of all arrays with an axis of bodies."""
        return [Body(**one) for one in self._handle.bodies()]

    @property
    def inputs(self) -> List[Input]:
        """In the order of all arrays with an axis of inputs."""
        return [Input(**one) for one in self._handle.inputs()]

    @property
    def constants(self) -> Dict[str, Constant]:
        """The numbers of the laws by name: "segment_1.chamber_2.moment_gain", "segment_1.bending_stiffness.base" ..."""
        return {one["name"]: Constant(**one) for one in self._handle.constants()}

    @property
    def effects(self) -> List[Dict[str, Any]]:
        """The effects that the file names, each {"id": ..., "numbers": {name with unit: value}, "sd": {name: sd}}.

        Empty for most arms. "sd" has the standard deviations that the file states, in the units of their numbers (SI).
        Estimates include them, together with :attr:`effects_correlations`.
        """
        return self._handle.effects()

    @property
    def effects_correlations(self) -> EffectsCorrelations:
        """Names, standard deviations (p,) and correlations (p, p) of the p numbers of ``effects`` that have an sd above 0."""
        return EffectsCorrelations(**self._handle.effects_correlations())

    def with_constants(self, values: Mapping[str, float]) -> "Arm":
        """Another arm whose file has these ``values`` (SI, by name). Bodies and payload keep their fraction of a length.

        Raises ValueError for a name that the arm does not have, or a value outside its range; ArmError where the file is
        written in a way that cannot be edited.
        """
        if not isinstance(values, Mapping):
            raise wrong("values", values, "a dict of numbers by name")
        return Arm(self._handle.with_constants({text_of("values", name): float(numbers(f"values['{name}']", value))
                                                for name, value in values.items()}))

    def to_dict(self) -> Dict[str, Any]:
        """The file's keys as nested dicts and lists; numbers in the units that their keys or values name there."""
        return self._handle.keys()

    def save(self, path: Path, *, force: bool = False) -> None:
        """Writes ``text`` to ``path``. The file appears whole or not at all; FileExistsError where there is one, unless ``force``."""
        write_text(path, self.text, force)


def write_text(path: Path, text: str, force: bool) -> None:
    """A file that appears whole or not at all."""
    path = path_of("path", path)
    if not force and os.path.exists(path):
        raise FileExistsError(f"{path}: exists; force=True replaces it")
    partial = f"{path}.{os.getpid()}.partial"
    try:
        with open(partial, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(partial, path)
    finally:
        if os.path.exists(partial):
            os.unlink(partial)


def load_arm(name: Path) -> Arm:
    """The arm of a file, or one that ships: ``name`` is a path, or a bare name like "online_200mm".

    Raises ArmError where there is no such file (the line names the arms that ship), or it is no valid arm (file, key, value
    and what is allowed).
    """
    return Arm(_softarm.find_arm(path_of("name", name), folders("arms")))


def parse_arm(text: str, source: str = "arm") -> Arm:
    """The arm of a ``text`` in YAML; ``source`` is its name in messages. Raises ArmError."""
    return Arm(_softarm.ArmHandle(text_of("text", text), text_of("source", source)))


def shipped_arms() -> List[str]:
    """Names of the arms that ship."""
    return _softarm.arm_names(folders("arms"))


def arm_keys() -> str:
    """Every key of the arm file with unit, range, default and meaning, as Markdown."""
    return _softarm.arm_keys()


def handle_of(arm: Arm) -> "_softarm.ArmHandle":
    if not isinstance(arm, Arm):
        raise wrong("arm", arm, "an Arm; load_arm makes one of a file")
    return arm._handle


def gravity_of(arm: Arm, gravity_base_m_s2: Optional[Any]) -> Floats:
    return np.array(arm._handle.gravity_base_m_s2 if gravity_base_m_s2 is None else gravity_base_m_s2, dtype=float)
