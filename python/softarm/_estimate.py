"""Estimates of frames, trials and bags."""
from typing import Any, Dict, Iterable, List, NoReturn, Optional, Union

import numpy as np

from . import _softarm
from ._arm import Arm, handle_of
from ._common import (Bools, Floats, Path, Progress, Words, jobs_of, numbers, pandas, paths_of, plain_dict, progress_of, set_options,
                      warn)
from ._mismatch import Alarm, Mismatch
from ._trial import Trial, handles_of

_STATUSES = np.array(_softarm.statuses())
# Column of estimates.csv, and the array that it is.
_COLUMNS = (("M0", "M0_nm"), ("phi", "phi_rad"), ("EI", "EI_nm2"), ("L", "L_m"), ("payload", "payload_kg"),
            ("sd_M0", "sd_M0_nm"), ("sd_phi", "sd_phi_rad"), ("sd_EI", "sd_EI_nm2"), ("sd_L", "sd_L_m"),
            ("sd_payload", "sd_payload_kg"), ("identifiable_EI", "identifiable_EI"),
            ("identifiable_payload", "identifiable_payload"), ("theta_tip", "theta_tip_rad"))
_FLAGS = ("identifiable_EI", "identifiable_payload", "settling")


class Estimates:
    """What was estimated of n frames of an arm with s segments, b bodies and p points of the backbone.

    ``stamp_s`` (n,) s; ``status`` (n,): "ok", or why the frame has no estimate.
    Of the segments, (n, s): ``M0_nm`` actuation moment, ``phi_rad`` direction of bending, ``EI_nm2`` bending stiffness,
    ``L_m`` length, their standard deviations ``sd_M0_nm``, ``sd_phi_rad``, ``sd_EI_nm2``, ``sd_L_m``, and
    ``identifiable_EI`` (bool): the frame determines EI well enough to use it.
    Of the arm, (n,): ``payload_kg``, ``sd_payload_kg``, ``identifiable_payload`` (bool), ``settling`` (bool; the payload has just
    changed, and nothing is identifiable), ``theta_tip_rad`` angle between the tangents of base and tip, ``rms_residual_m`` of
    the bodies, ``reduced_chi_square``.
    Shapes in the rod's base frame: ``tip_p_base_m`` (n, 3), ``backbone_p_base_m`` and ``backbone_curvature_per_m`` (n, p, 3),
    ``bodies_measured_base_m`` and ``bodies_estimated_base_m`` (n, b, 3).
    ``mismatch``: :class:`Mismatch`, what the live monitor says at every frame; ``alarms``: sudden changes that it found, as in
    the summary. ``summary``: the table that ``softarm estimate`` prints. ``warnings``: topics that the recording lacks, or of
    which messages cannot be read.

    NaN: neither estimated nor known; of a standard deviation: known, or not determined.
    """

    def __init__(self, raw: Dict[str, Any], body_names: List[str]) -> None:
        self.name: str = raw.pop("name")
        self.summary: str = raw.pop("summary")
        self.warnings: List[str] = raw.pop("warnings")
        self.status = _STATUSES[raw.pop("status_code")]
        mismatch = raw.pop("mismatch")
        self.alarms: List[Alarm] = [Alarm(*one) for one in mismatch.pop("alarms")]
        self.mismatch = Mismatch(mismatch, raw["stamp_s"], body_names)
        for name, array in raw.items():
            setattr(self, name, array.astype(bool) if name in _FLAGS else array)

    stamp_s: Floats
    status: Words
    M0_nm: Floats
    phi_rad: Floats
    EI_nm2: Floats
    L_m: Floats
    payload_kg: Floats
    sd_M0_nm: Floats
    sd_phi_rad: Floats
    sd_EI_nm2: Floats
    sd_L_m: Floats
    sd_payload_kg: Floats
    identifiable_EI: Bools
    identifiable_payload: Bools
    settling: Bools
    theta_tip_rad: Floats
    tip_p_base_m: Floats
    rms_residual_m: Floats
    reduced_chi_square: Floats
    backbone_p_base_m: Floats
    backbone_curvature_per_m: Floats
    bodies_measured_base_m: Floats
    bodies_estimated_base_m: Floats

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.stamp_s)

    def __repr__(self) -> str:
        return f"<softarm.Estimates {self.name}: {len(self)} frames, {int(self.ok.sum())} ok>"

    @property
    def ok(self) -> Bools:
        """(n,) bool: the frame has an estimate."""
        return np.asarray(self.status == "ok")

    def to_dict(self) -> Dict[str, Any]:
        """All arrays, as lists; None for NaN; ``mismatch`` and ``alarms`` as dicts."""
        return plain_dict({**vars(self), "mismatch": self.mismatch.to_dict(), "alarms": [one._asdict() for one in self.alarms]})

    def to_pandas(self) -> Any:
        """A DataFrame with the rows and columns of ``estimates.csv``: one row per frame and segment, segments from 1."""
        n, s = self.M0_nm.shape
        columns: Dict[str, Any] = {"stamp": np.repeat(self.stamp_s, s), "segment": np.tile(np.arange(1, s + 1), n),
                                   "status": np.repeat(self.status, s)}
        for column, name in _COLUMNS:
            array = getattr(self, name)
            array = array.astype(int) if array.dtype == bool else array  # 0 and 1, as there
            columns[column] = array.ravel() if array.ndim == 2 else np.repeat(array, s)
        for axis, letter in enumerate("xyz"):
            columns["tip_" + letter] = np.repeat(self.tip_p_base_m[:, axis], s)
        columns["rms_residual"] = np.repeat(self.rms_residual_m, s)
        columns["settling"] = np.repeat(self.settling.astype(int), s)
        return pandas().DataFrame(columns)


def _options(given: Dict[str, Any], others: Dict[str, Any]) -> "_softarm.EstimateOptions":
    """``others``: none of them."""
    for name in others:
        raise TypeError(f"no option '{name}'; there are {', '.join(given)}")
    options = _softarm.EstimateOptions()
    set_options(options, given)
    return options


class Estimator:
    """The live node's estimator over one stream of frames: a trial, or frames as they come.

    Options, all by default the arm file's: ``method`` ("full_points", "end_orientation", "cc_points", "cc_endpoint"),
    ``unknown`` ("stiffness", "payload", "both"), ``objective`` ("least_squares", "sum_of_distances"), ``dynamics`` ("static",
    "modal"), ``prior`` (the arm's laws at the inputs as a prior), ``robust``, ``window_s`` (frames of this last time share EI
    and payload; 0: none do), ``payload_kg`` (the known payload; what the frames say is not used), ``backbone_points``,
    ``alarm_threshold_sd`` (of the live monitor: a change of so many standard deviations is an alarm; from 3 on).
    Raises ValueError for what is not allowed.
    """

    def __init__(self, arm: Arm, *, method: Optional[str] = None, unknown: Optional[str] = None,
                 objective: Optional[str] = None, dynamics: Optional[str] = None, prior: Optional[bool] = None,
                 robust: Optional[bool] = None, window_s: Optional[float] = None, payload_kg: Optional[float] = None,
                 backbone_points: int = 21, alarm_threshold_sd: float = 6.0) -> None:
        handle = handle_of(arm)
        self.arm = arm
        self._body_names = [one.name for one in arm.bodies]
        self._handle = _softarm.EstimatorHandle(handle, _options(dict(
            method=method, unknown=unknown, objective=objective, dynamics=dynamics, prior=prior, robust=robust, window_s=window_s,
            payload_kg=payload_kg, backbone_points=backbone_points, alarm_threshold_sd=alarm_threshold_sd), {}))

    @property
    def notes(self) -> List[str]:
        """Which effects of the arm file are in the fit, and what these options cannot give, a line each."""
        return self._handle.notes()

    def reset(self) -> None:
        """Forgets the frames before: the next one starts cold, with an empty window."""
        self._handle.reset()

    def frame(self, stamp_s: float, bodies_p_mocap_m: Any, *, bodies_q_mocap_xyzw: Any = None, base_p_mocap_m: Any = None,
              base_q_mocap_xyzw: Any = None, inputs: Any = None, payload_kg: Optional[float] = None) -> Estimates:
        """The next frame, at ``stamp_s``: ``bodies_p_mocap_m`` (b, 3) m and, where known, ``bodies_q_mocap_xyzw`` (b, 4),
        ``base_p_mocap_m`` (3,) m and ``base_q_mocap_xyzw`` (4,) of the base's body, ``inputs`` ({name: number}, or (i,); Pa, N, rad)
        and ``payload_kg``. NaN: not seen. Returns estimates of one frame. Bad measurements are a ``status``, not an exception.

        Raises ValueError for wrong shapes, names and infinity.
        """
        def row(name: str, values: Any) -> Any:
            return None if values is None else numbers(name, values)[np.newaxis]

        trial = Trial.from_arrays(
            self.arm, row("stamp_s", stamp_s), row("bodies_p_mocap_m", bodies_p_mocap_m),
            bodies_q_mocap_xyzw=row("bodies_q_mocap_xyzw", bodies_q_mocap_xyzw),
            base_p_mocap_m=row("base_p_mocap_m", base_p_mocap_m), base_q_mocap_xyzw=row("base_q_mocap_xyzw", base_q_mocap_xyzw),
            inputs=inputs if inputs is None or isinstance(inputs, dict) else row("inputs", inputs), payload_kg=payload_kg,
            name="frame")
        return Estimates(self._handle.estimate_frame(trial._handle), self._body_names)

    def trial(self, trial: Trial, *, progress: Optional[Progress] = None) -> Estimates:
        """All frames of a ``trial``, after those that came before; ``reset()`` first for a trial of its own. ``progress``: called
        with (share done, what is being done)."""
        return Estimates(self._handle.estimate_trial(handles_of([trial])[0], progress_of(progress)), self._body_names)


def estimate(trial: Trial, *, arm: Optional[Arm] = None, method: Optional[str] = None, unknown: Optional[str] = None,
             objective: Optional[str] = None, dynamics: Optional[str] = None, prior: Optional[bool] = None,
             robust: Optional[bool] = None, window_s: Optional[float] = None, payload_kg: Optional[float] = None,
             backbone_points: int = 21, alarm_threshold_sd: float = 6.0, progress: Optional[Progress] = None,
             **others: "NoReturn") -> Estimates:
    """Every frame of a ``trial``, by its arm or another ``arm`` with the same bodies and inputs.

    ``method``, ``unknown``, ``objective``, ``dynamics``, ``prior``, ``robust``, ``window_s`` (s), ``payload_kg`` (kg),
    ``backbone_points``, ``alarm_threshold_sd``: as of :class:`Estimator`. ``progress``: called with (share done, what is being done).
    """
    options = dict(method=method, unknown=unknown, objective=objective, dynamics=dynamics, prior=prior, robust=robust,
                   window_s=window_s, payload_kg=payload_kg, backbone_points=backbone_points,
                   alarm_threshold_sd=alarm_threshold_sd)
    _options(options, others)
    handles_of([trial])
    estimator = Estimator(trial.arm if arm is None else arm, **options)  # type: ignore[arg-type]
    for note in estimator.notes:
        warn(note)
    return estimator.trial(trial, progress=progress)


def estimate_bags(arm: Arm, paths: Union[Path, Iterable[Path]], *, method: Optional[str] = None, unknown: Optional[str] = None,
                  objective: Optional[str] = None, dynamics: Optional[str] = None, prior: Optional[bool] = None,
                  robust: Optional[bool] = None, window_s: Optional[float] = None, payload_kg: Optional[float] = None,
                  backbone_points: int = 21, alarm_threshold_sd: float = 6.0, jobs: int = 0,
                  progress: Optional[Progress] = None, **others: "NoReturn") -> List[Estimates]:
    """Every frame of bags, in the order of ``paths``: ``softarm estimate`` without its files, several bags at a time.

    ``method``, ``unknown``, ``objective``, ``dynamics``, ``prior``, ``robust``, ``window_s`` (s), ``payload_kg`` (kg),
    ``backbone_points``, ``alarm_threshold_sd``: as of :class:`Estimator`; with ``payload_kg`` the payload's topic is not read.
    ``jobs``: bags at a time, 0: one per processor. ``progress``: called with (share done, what is being done).
    Raises BagError for the first bag that cannot be used.
    """
    made = _options(dict(method=method, unknown=unknown, objective=objective, dynamics=dynamics, prior=prior, robust=robust,
                         window_s=window_s, payload_kg=payload_kg, backbone_points=backbone_points,
                         alarm_threshold_sd=alarm_threshold_sd), others)
    for note in _softarm.EstimatorHandle(handle_of(arm), made).notes():
        warn(note)
    names = [one.name for one in arm.bodies]
    found = _softarm.estimate_bags(arm._handle, paths_of(paths), made, jobs_of(jobs), progress_of(progress))
    results = [Estimates(raw, names) for raw in found]
    for result in results:
        for line in result.warnings:
            warn(line)
    return results
