"""Recorded trials as NumPy arrays."""
import os
from typing import Any, Dict, Iterable, List, Optional, Tuple, Union

import numpy as np

from . import _softarm
from ._arm import Arm, handle_of
from ._common import Floats, Path, Progress, folders, jobs_of, numbers, pandas, path_of, paths_of, plain_dict, progress_of, table, text_of, warn, wrong


class Trial:
    """One recording, frame by frame, as the estimator sees it. n frames, b bodies, i inputs; NaN: not seen, not known.

    Its arrays are made anew at every access: keep them in a variable. It does not change.
    """

    def __init__(self, handle: "_softarm.TrialHandle", arm: Arm) -> None:
        self._handle = handle
        self.arm = arm
        self._arrays: Optional[Dict[str, Floats]] = None

    def __repr__(self) -> str:
        return f"<softarm.Trial {self.name}: {len(self)} frames>"

    def __len__(self) -> int:
        """Number of frames."""
        return self._handle.frames

    def _array(self, name: str) -> Floats:
        if self._arrays is None:
            self._arrays = self._handle.arrays()
        return self._arrays[name].copy()

    @property
    def name(self) -> str:
        """That of the bag, without ".bag"."""
        return self._handle.name

    @property
    def warnings(self) -> List[str]:
        """Topics of the arm that the recording lacks, or of which messages cannot be read, a line each."""
        return self._handle.warnings

    @property
    def rejected(self) -> Dict[str, int]:
        """Samples that no frame used, by reason and source: {"frozen ring_2": 12}."""
        return self._handle.rejected

    @property
    def stamp_s(self) -> Floats:
        """(n,) s: of the bodies' clock; its latency is subtracted."""
        return self._array("stamp_s")

    @property
    def bodies_p_mocap_m(self) -> Floats:
        """(n, b, 3) m, in the mocap frame."""
        return self._array("bodies_p_mocap_m")

    @property
    def bodies_q_mocap_xyzw(self) -> Floats:
        """(n, b, 4), as the driver reports them."""
        return self._array("bodies_q_mocap_xyzw")

    @property
    def base_p_mocap_m(self) -> Floats:
        """(n, 3) m: of the base's body; NaN for a fixed base."""
        return self._array("base_p_mocap_m")

    @property
    def base_q_mocap_xyzw(self) -> Floats:
        """(n, 4): of the base's body."""
        return self._array("base_q_mocap_xyzw")

    @property
    def inputs(self) -> Floats:
        """(n, i) gauge Pa, Pa below ambient, N or rad, at the frames' stamps; see ``Arm.inputs``."""
        return self._array("inputs")

    @property
    def payload_kg(self) -> Floats:
        """(n,) kg."""
        return self._array("payload_kg")

    @property
    def series(self) -> Dict[str, Tuple[Floats, Floats]]:
        """Each input by its own samples: (stamps in s, values). Empty where time went back in the recording."""
        return self._handle.series()

    def to_dict(self) -> Dict[str, Any]:
        """Names and arrays, as lists; None for NaN."""
        self._array("stamp_s")
        assert self._arrays is not None
        return plain_dict({"name": self.name, "bodies": [one.name for one in self.arm.bodies],
                      "input_names": [one.name for one in self.arm.inputs], **self._arrays})

    def to_pandas(self) -> Any:
        """A DataFrame with a row per frame, indexed by ``stamp_s``: ``ring_1_x_m`` ..., ``chamber_1_Pa`` ..., ``payload_kg``."""
        columns: Dict[str, Floats] = {}
        p = self.bodies_p_mocap_m
        for k, body in enumerate(self.arm.bodies):
            for axis, letter in enumerate("xyz"):
                columns[f"{body.name}_{letter}_m"] = p[:, k, axis]
        values = self.inputs
        for k, one in enumerate(self.arm.inputs):
            columns[f"{one.name}_{one.unit}"] = values[:, k]
        columns["payload_kg"] = self.payload_kg
        module = pandas()
        return module.DataFrame(columns, index=module.Index(self.stamp_s, name="stamp_s"))

    @staticmethod
    def from_arrays(arm: Arm, stamp_s: Any, bodies_p_mocap_m: Any, *, bodies_q_mocap_xyzw: Any = None,
                    base_p_mocap_m: Any = None, base_q_mocap_xyzw: Any = None, inputs: Any = None, payload_kg: Any = None,
                    name: str = "trial") -> "Trial":
        """A trial called ``name`` out of arrays, with the shapes and units of the properties of the same names.

        ``stamp_s`` (n,) s; ``bodies_p_mocap_m`` (n, b, 3) m; ``bodies_q_mocap_xyzw`` (n, b, 4); ``base_p_mocap_m`` (n, 3) m and
        ``base_q_mocap_xyzw`` (n, 4), needed where the arm's base is a measured body; ``inputs`` (n, i) or {name: number or (n,)},
        Pa, N or rad, names left out are 0, and None is not known; ``payload_kg`` (n,) or one number, kg. NaN: not seen, not known.
        Raises ValueError for wrong shapes, infinity, stamps that do not increase, and names that the arm does not have.
        """
        handle = handle_of(arm)
        stamps = np.atleast_1d(numbers("stamp_s", stamp_s))
        n = stamps.shape[0]
        names = [one.name for one in arm.inputs]
        drive = np.full((n, len(names)), np.nan) if inputs is None else table(inputs, names, n)
        payload = numbers("payload_kg", np.nan if payload_kg is None else payload_kg)
        payload = np.full(n, payload) if payload.ndim == 0 else payload
        bodies_q, base_p, base_q = (None if one is None else numbers(label, one) for label, one in (
            ("bodies_q_mocap_xyzw", bodies_q_mocap_xyzw), ("base_p_mocap_m", base_p_mocap_m), ("base_q_mocap_xyzw", base_q_mocap_xyzw)))
        return Trial(_softarm.trial_of(handle, text_of("name", name), stamps, numbers("bodies_p_mocap_m", bodies_p_mocap_m), bodies_q, base_p,
                                       base_q, drive, payload), arm)


def handles_of(trials: Iterable[Trial]) -> "List[_softarm.TrialHandle]":
    if not isinstance(trials, Iterable):
        raise wrong("trials", trials, "a list of Trials")
    trials = list(trials)
    for trial in trials:
        if not isinstance(trial, Trial):
            raise wrong("trials", trial, "Trials; read_bags makes them of bags")
    return [trial._handle for trial in trials]


def _told(trials: List[Trial]) -> List[Trial]:
    for trial in trials:
        for line in trial.warnings:
            warn(line)
    return trials


def read_bags(arm: Arm, paths: Union[Path, Iterable[Path]], *, use_payload: bool = True, jobs: int = 0,
              progress: Optional[Progress] = None) -> List[Trial]:
    """Trials of bags, read for this arm, in the order of ``paths``.

    ``use_payload``: whether the payload's topic is read. ``jobs``: bags at a time, 0: one per processor.
    ``progress``: called with (share done, what is being done).
    Raises BagError for the first bag that is missing, damaged or without a frame, or named like another.
    """
    handles = _softarm.read_bags(handle_of(arm), paths_of(paths), bool(use_payload), jobs_of(jobs), progress_of(progress))
    return _told([Trial(handle, arm) for handle in handles])


def read_bag(arm: Arm, path: Path, *, use_payload: bool = True, progress: Optional[Progress] = None) -> Trial:
    """The trial of the bag ``path``; ``use_payload`` and ``progress`` as of :func:`read_bags`."""
    return read_bags(arm, [path_of("path", path)], use_payload=use_payload, jobs=1, progress=progress)[0]


def read_csv(arm: Arm, layout: Path, path: Path, *, inputs: Path = "", use_payload: bool = True,
             progress: Optional[Progress] = None) -> List[Trial]:
    """Trials of the CSV recording ``path`` by a ``layout``: a file, or the name of one that ships. As ``softarm import`` and a bag
    give them.

    ``inputs``: the file that is joined, where the layout has a key ``join``. Several trials where it has a trial column.
    ``use_payload``: whether the payload's column is read; ``progress``: called with (share done, what is being done).
    Raises CsvError for a layout or a recording that cannot be used, BagError where it has no frame for this arm.
    """
    given = path_of("layout", layout)
    found = given
    if not os.path.isfile(given):
        shipped = [os.path.join(folder, given + ".yaml") for folder in folders("layouts")]
        found = next((one for one in shipped if os.path.isfile(one)), given)
    joined = "" if isinstance(inputs, str) and not inputs else path_of("inputs", inputs)
    handles = _softarm.read_csv(handle_of(arm), found, path_of("path", path), joined, bool(use_payload), progress_of(progress))
    return _told([Trial(handle, arm) for handle in handles])
