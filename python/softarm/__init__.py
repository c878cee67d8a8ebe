"""Estimates, models and diagnoses of soft continuum arms, as NumPy arrays.

    import softarm
    arm = softarm.load_arm("online_200mm")
    trial = softarm.read_bag(arm, "trial.bag")
    found = softarm.estimate(trial)
    print(found.summary, found.EI_nm2[found.identifiable_EI])

Everywhere: SI units, and the unit in the name (``stamp_s``, ``payload_kg``, ``EI_nm2`` in N m²); NaN where a value is neither
measured nor known, None in ``to_dict()``. What cannot be done raises :class:`Error` or ValueError with one clear line. Long
calls release Python's lock, end at Ctrl-C, and tell ``progress(share, what)`` where it is given.
"""
import importlib.util

if importlib.util.find_spec(__name__ + "._softarm") is None:
    raise ImportError("softarm was installed without its compiled part, or for another Python than this one: scripts/python "
                      "builds and finds it, for /usr/bin/python3")

from ._arm import Arm, Body, Constant, EffectsCorrelations, Input, Segment, arm_keys, load_arm, parse_arm, shipped_arms
from ._check import Check, Finding, check
from ._common import SoftarmWarning
from ._diagnose import Diagnosis, catalogue, diagnose
from ._estimate import Estimates, Estimator, estimate, estimate_bags
from ._identify import FittedConstant, Identification, identify
from ._mismatch import Alarm, Mismatch
from ._model import Jacobians, Model, Shapes
from ._simulate import Simulation, simulate
from ._softarm import ArmError, BagError, CsvError, Error, IdentifyError, __version__
from ._tables import read_table
from ._trial import Trial, read_bag, read_bags, read_csv

__all__ = [
    "Alarm", "Arm", "ArmError", "BagError", "Body", "Check", "Constant", "CsvError", "Diagnosis",
    "EffectsCorrelations", "Error", "Estimates", "Estimator", "Finding", "FittedConstant", "Identification",
    "IdentifyError", "Input", "Jacobians", "Mismatch", "Model", "Segment", "Shapes", "Simulation", "SoftarmWarning",
    "Trial", "__version__", "arm_keys", "catalogue", "check", "diagnose", "estimate", "estimate_bags", "identify",
    "load_arm", "parse_arm", "read_bag", "read_bags", "read_csv", "read_table", "shipped_arms", "simulate",
]
