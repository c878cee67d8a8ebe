"""Scores of the proof: what a report says against what was hidden. Pure functions, no files.

A result is {"kind", "truth", "report", "baselines", ...} as prove_cases.py collects them; `truth` as `prove draw` writes it,
`report` a report.json. A decision is what a report, or a baseline, comes to:
{"verdict", "named": [{"name", "probability", "confusable_with"}], "ranking": [names]}.
"""
import math

import prove_real_score

KINDS = ["none", "single_strong", "single_weak", "pair", "outside", "compensated", "class_only", "untidy_none",
         "untidy_single", "untidy_pair", "untidy_outside", "solid_none", "solid_single", "solid_compensated", "intervention", "control"]
BASELINES = ["per_frame", "bic", "lasso", "gp"]
CONFIDENT = 0.9
INTERVAL_SD = 1.6449  # half a 90 % interval
LEAST_BEYOND = 8.0  # standard deviations: less, and an effect of the catalogue says it as well
# A signature acts like what is hidden where it explains this much of what that leaves beside the arm's constants, and nearly as
# much as the best one does.
LIKE_AT_LEAST, LIKE_THE_BEST = 0.5, 0.9
LENGTH_M = 0.2  # of the arms of the campaigns
LEAST_MASS = 1e-3  # of the arm's: what weighing does not see
# With which power a number goes with the unit of force. Recordings hold no scale of forces but the masses of the arm file.
POWER_OF_FORCE = {"compliance_per_n": -1, "compliance_rad_per_nm": -1, "stiffness_n_per_m": 1, "mass_kg": 1}
LEAST_BIAS = 0.02  # of EI: a smaller one cannot be distinguished from the fit's own error


def named_in(report):
    """Small departures, too, were found, and count as such; last what is hardly there, of which the probability alone counts."""
    stand_ins = [{**named, "stand_in": True} for named in report.get("stand_ins", [])]
    small = [{**named, "small": True} for named in report.get("small_departures", [])]
    return report["effects"] + small + stand_ins


def decision_of_report(report):
    """Without a report it says nothing."""
    if report is None:
        return {"verdict": "failed", "named": [], "ranking": [], "findings": {}}
    names = [key for key in prove_real_score.BEFORE_ALL if key in report]
    before = [{"name": name, "probability": report[name].get("probability", 1.0), "parameters": {}} for name in names]
    return {"verdict": report["verdict"],
            "named": before + named_in(report),
            "ranking": names + [c["name"] for c in report["ranking"]],
            "findings": {c["name"]: c.get("finding") for c in report["ranking"]}}


def decision_of_baseline(item):
    verdict = "consistent" if not item["alarm"] else "explained" if item["effects"] else "unknown"
    return {"verdict": verdict, "named": item["effects"], "ranking": item["ranking"], "findings": {}}


def beside_control(result, decided):
    """A decision, decided(result), with the names that its control was given; one without a control, as it is."""
    decision, control = decided(result), result.get("control")
    of_control = decided(control) if control else None
    if decision is None or of_control is None:
        return decision
    return {**decision, "before": prove_real_score.of_both(decision, of_control, result["truth"])}


def decision_of(result):
    return beside_control(result, lambda of: decision_of_report(of["report"]))


def baseline_decision(result, method):
    """None where the method has not decided this case."""
    def own(of):
        return decision_of_baseline(of["baselines"][method]) if of.get("baselines") and method in of["baselines"] else None

    return beside_control(result, own)


def everything(truth):
    """Effects and distractors; an arm of another mass looks like payloads that are told wrong, in proportion, and adds to them."""
    found = truth["effects"] + truth["distractors"]
    ratio = truth.get("mass_ratio", 1.0)
    if abs(ratio - 1.0) <= LEAST_MASS:
        return found
    told = [effect for effect in found if effect["effect"] == "payload_scale"]
    share = math.prod([ratio] + [1.0 + effect["values"]["share"] for effect in told]) - 1.0
    return [effect for effect in found if effect not in told] + [{"effect": "payload_scale", "values": {"share": share}}]


def asked_for(truth):
    """The effects that were hidden, as everything() has them: payloads told wrong with what the arm's mass adds to them."""
    own = truth["effects"]
    told = any(effect["effect"] == "payload_scale" for effect in own)
    return [effect for effect in everything(truth) if effect in own or (told and effect["effect"] == "payload_scale")]


def hidden(truth):
    """Ids that are right to name: the effects, and for one outside the catalogue that which no recording can distinguish from it."""
    names = [effect["effect"] for effect in truth["effects"] if effect["catalogued"]]
    return names + [effect["like"] for effect in truth["effects"] if effect.get("like")]


def acting_alike(ideal):
    """Ids of the effects of the catalogue whose signatures act like what is hidden; `ideal` is sealed with the draw."""
    best = max((item["explains"] for item in ideal), default=0.0)
    return [item["effect"] for item in ideal if item["explains"] >= max(LIKE_AT_LEAST, LIKE_THE_BEST * best)]


def sealed_class(truth):
    """Ids that what is hidden may be called besides its own: of something outside the catalogue those that act like it, too."""
    outside = truth.get("kind") in ("outside", "untidy_outside")
    return truth.get("class", []) + (acting_alike(truth["ideal"]) if outside else [])


def class_of(named):
    return [named["name"], *named.get("confusable_with", [])]


def is_elsewhere(named, truth):
    """Whether it is said of one chamber where another one has it, or others have."""
    said_of = (named.get("parameters") or {}).get("chamber", {}).get("value", 0.0)
    theirs = [effect["values"].get("chamber", 0.0) for effect in everything(truth)
              if effect["effect"] == named["name"] and "chamber" in effect.get("values", {})]
    return said_of > 0.0 and bool(theirs) and all(chamber not in (0.0, said_of) for chamber in theirs)


def names_of_class(named, truth):
    """class_of(), less its own name where it is said of a wrong chamber."""
    return class_of(named)[1:] if is_elsewhere(named, truth) else class_of(named)


def right(named, truth):
    """Whether a named effect, or a rival that it is said to be confusable with, is there; distractors are. One of a wrong chamber is not."""
    there = set(hidden(truth)) | {effect["effect"] for effect in everything(truth)} | set(sealed_class(truth))
    return any(name in there for name in names_of_class(named, truth))


def said(decision):
    """What is said to be there; what a report lists as hardly there (its stand-ins) neither accuses nor finds anything."""
    return [named for named in decision["named"] if not named.get("stand_in")]


def is_alarm(decision):
    return bool(said(decision)) or decision["verdict"] not in ("consistent", "cannot_tell", "failed")


def judged(decision, truth):
    """What is named and can be judged: of an untouched recording of a real arm only what was asked of it."""
    if "asked" in truth:
        return [named for named in decision["named"] if named["name"] in truth["asked"]]
    return prove_real_score.stated(decision)


def is_confident_and_wrong(decision, truth):
    return any((named.get("probability") or 0.0) > CONFIDENT and not right(named, truth) for named in judged(decision, truth))


def beyond_catalogue(truth):
    """Signal to noise of what the best single effect of the catalogue leaves of what is hidden."""
    explained = max((item["explains"] for item in truth["ideal"]), default=0.0)
    snr = math.sqrt(sum(effect["signal"]["leftover_snr"] ** 2 for effect in truth["effects"]))
    return snr * math.sqrt(max(0.0, 1.0 - explained))


def is_of_the_kind(decision, truth):
    """Whether something outside the catalogue is said to be its nearest kind there (sealed with the draw), and that more is left."""
    return (decision["verdict"] == "partly_explained" and bool(said(decision))
            and any(name in sealed_class(truth) for name in class_of(said(decision)[0])))


EVER = ("confident_wrong", "false_alarm")  # count for what nobody could see, too


def marks(kind, decision, truth):
    """What counts for this kind: rate -> bool. Of a case of which the sealed file says that it is not clear (what is hidden
    leaves less than the background, or than half of the position noise) nothing of its naming counts."""
    found = all_marks(kind, decision, truth)
    return found if truth.get("clear", True) else {rate: value for rate, value in found.items() if rate in EVER}


def all_marks(kind, decision, truth):
    """The same whether it is clear or not."""
    named_there = said(decision)
    names = [None if is_elsewhere(named, truth) else named["name"] for named in named_there]
    there = hidden(truth)
    found = {"confident_wrong": is_confident_and_wrong(decision, truth)}
    if kind == "none":
        found["false_alarm"] = is_alarm(decision)
    if kind == "control":
        found["false_alarm"] = any(prove_real_score.is_named(named) for named in judged(decision, truth))
    if kind == "intervention":
        found.update(prove_real_score.marks(decision, truth, is_alarm(decision)))
    if kind in ("untidy_none", "solid_none"):  # small departures are there, and may be named
        found["false_alarm"] = any(not right(named, truth) for named in named_there)
    if kind in ("single_strong", "single_weak", "compensated", "class_only", "untidy_single", "solid_single", "solid_compensated"):
        found["top1"] = names[:1] == there[:1]
        found["top3"] = is_alarm(decision) and any(name in there for name in decision["ranking"][:3])
        alike = there + truth.get("class", [])
        found["right_class"] = bool(named_there) and any(name in alike for name in names_of_class(named_there[0], truth))
    if kind in ("pair", "untidy_pair"):
        found["both_named"] = all(name in names for name in there)
        found["top1"] = bool(names) and names[0] in there
        found["right_class"] = all(any(name in names_of_class(named, truth) for named in named_there) for name in there)
    if kind in ("outside", "untidy_outside") and beyond_catalogue(truth) >= LEAST_BEYOND:
        found["unknown"] = decision["verdict"] == "unknown" or is_of_the_kind(decision, truth)
    if kind in ("compensated", "solid_compensated"):
        in_a_class = any(name in class_of(named) for named in named_there for name in there + truth.get("class", []))
        found["found_or_cannot_tell"] = (in_a_class or decision["verdict"] == "cannot_tell"
                                         or any(decision["findings"].get(name) == "cannot_tell" for name in there))
    return found


def polar(size, azimuth_deg):
    return size * math.cos(math.radians(azimuth_deg)), size * math.sin(math.radians(azimuth_deg))


def true_parameters(effect, length_m):
    """The catalogue's parameters that a hidden effect has; empty where its form is another than the catalogue's."""
    if "parameters" in effect:
        return effect["parameters"]
    name, form, v = effect["effect"], effect.get("form", ""), effect["values"]
    if name in ("payload_scale", "axial_memory", "vacuum_shortening", "vacuum_gain", "jamming_memory", "chamber_mismatch",
                "pressure_elongation"):
        return {"share": v["share"]}
    # Records of when these had one form only name none.
    if name in ("stiffness_taper", "actuation_taper", "soft_spot") and form in ("", "linear", "even"):
        return {"share": v["share"]}
    if (name, form) in (("gain_nonlinearity", "quadratic"), ("pressure_stiffening", "linear"), ("pressure_leak", "steady"),
                        ("mass_distribution", "taper"), ("creep", "maxwell"), ("creep", "wall")):
        return {"share": v["share"], **({"time_s": v["time_s"]} if name == "creep" else {})}
    if name == "rigid_ends":
        return {"base_m": v["base_m"], "tip_m": v["tip_m"]}
    if name == "base_compliance":
        return {"compliance_rad_per_nm": 1.0 / v["stiffness_nm_per_rad"]}
    if (name, form) == ("base_free_play", "ring"):
        return {"play_rad": math.radians(v["play_deg"])}
    if (name, form) == ("temperature", "sine"):
        phase, kelvin = math.radians(v["phase_deg"]), v["amplitude_k"]
        return {"stiffness_sin": kelvin * v["stiffness_share_per_k"] * math.cos(phase),
                "stiffness_cos": kelvin * v["stiffness_share_per_k"] * math.sin(phase)}
    if name == "axial_compliance":
        return {"compliance_per_n": 1.0 / v["axial_stiffness_n"]}
    if name == "shear":
        return {"compliance_per_n": 1.0 / v["shear_stiffness_n"]}
    if name in ("base_tilt", "gravity_direction"):
        return dict(zip(("towards_x_rad", "towards_y_rad"), polar(math.radians(v["angle_deg"]), v["azimuth_deg"])))
    if name == "rest_curvature":
        return dict(zip(("towards_x_per_m", "towards_y_per_m"), polar(v["curvature_per_m"], v["azimuth_deg"])))
    if name == "payload_offset":
        x, y = polar(v["lateral_m"], v["azimuth_deg"])
        return {"x_m": x, "y_m": y, "z_m": v["axial_m"]}
    if name == "tip_mass":
        return {"mass_kg": v["mass_kg"]}
    if (name, form) == ("tether", "spring") or (name, form) == ("contact", "spring_wall"):
        return {"stiffness_n_per_m": v["stiffness_n_per_m"]}
    if (name, form) == ("pressure_lag", "first_order"):
        return {"delay_s": v["time_constant_s"]}
    if (name, form) == ("flow_limit", "slew"):
        return {"share": 1.0, "rise_pa_per_s": v["rise_pa_per_s"]}
    if name == "clock_offset":
        return {"offset_s": v["offset_s"]}
    if name == "clock_drift":  # the catalogue's session goes by the cameras' clock, the rig's by the other one
        drift = 1e-6 * v["drift_ppm"]
        return {"rate": drift / (1.0 + drift)}
    if (name, form) == ("strain_stiffening", "cubic"):
        return {"beta_m2": v["beta_m2"]}
    if (name, form) == ("pressure_offset", "pressure") and v["number"] >= 1:
        return {f"offset_{v['number']:.0f}_pa": v["offset_pa"]}
    if name == "bending_plane_offset":
        return {"angle_rad": math.radians(v["angle_deg"])}
    return {}


def true_place_m(effect, length_m):
    if effect["effect"] == "soft_spot" and "centre_fraction" in effect["values"]:
        return effect["values"]["centre_fraction"] * length_m
    if effect["effect"] == "soft_spot":  # of the solid arm
        return effect.get("parameters", {}).get("centre_m")
    if effect["effect"] == "contact" and effect.get("form") == "spring_wall":
        return effect["values"]["fraction"] * length_m
    return None


def said_place_m(named):
    """By the effect's own number, else the middle of where it is said to be."""
    for symbol in ("place_m", "centre_m"):
        if symbol in named["parameters"]:
            return named["parameters"][symbol]["value"]
    where = named.get("where", {})
    return 0.5 * (where["s_from"] + where["s_to"]) if "s_from" in where and "s_to" in where else None


def names_of(effect):
    """Ids by which an effect may be named whose numbers are compared."""
    return effect.get("names", [effect["effect"]])


def true_numbers(effect, truth):
    """The same as an arm file would have them that states the arm's mass as this one does: of an arm that is heavier than its file
    says by a ratio, all forces are smaller by it there."""
    ratio = truth.get("mass_ratio", 1.0)
    return {symbol: value / ratio ** POWER_OF_FORCE.get(symbol, 0) for symbol, value in true_parameters(effect, LENGTH_M).items()}


def interval_of(number):
    """The 90 % interval of a number of a report; None of one that its fits hold, which has none."""
    return (number["low"], number["high"]) if number.get("fitted", True) else None


def sizes(result):
    """Relative errors and hits of the 90 % intervals of the effects that were named rightly."""
    errors, hits, places = [], [], []
    truth = result["truth"]
    for effect in asked_for(truth):
        for named in prove_real_score.stated(decision_of(result)):
            if named["name"] not in names_of(effect):
                continue
            true = {symbol: value for symbol, value in true_numbers(effect, truth).items() if symbol in named["parameters"]}
            norm = math.sqrt(sum(value * value for value in true.values()))
            if norm > 0.0:
                off = [named["parameters"][symbol]["value"] - value for symbol, value in true.items()]
                errors.append(math.sqrt(sum(x * x for x in off)) / norm)
                intervals = [(interval_of(named["parameters"][symbol]), value) for symbol, value in true.items()]
                hits += [interval[0] <= value <= interval[1] for interval, value in intervals if interval]
            place, said = true_place_m(effect, LENGTH_M), said_place_m(named)
            if place is not None and said is not None:
                places.append(abs(said - place))
    return errors, hits, places


def ranks(result):
    """Where the true numbers of everything that is there, distractors too, lie in what is said of them: 0 below it, 1 above,
    evenly spread if intervals are right."""
    said = {named["name"]: named for named in prove_real_score.stated(decision_of(result))}
    found = []
    for effect in everything(result["truth"]):
        numbers = next((said[name]["parameters"] for name in names_of(effect) if name in said), {})
        for symbol, true in true_numbers(effect, result["truth"]).items():
            interval = interval_of(numbers[symbol]) if symbol in numbers else None
            if interval is None:
                continue
            value = numbers[symbol]["value"]
            far = interval[1] - value if true > value else value - interval[0]
            if far > 0.0:
                z = INTERVAL_SD * (true - value) / far
                found.append(0.5 * (1.0 + math.erf(z / math.sqrt(2.0))))
    return found


def unseen_rms_m(report, model):
    """Error of a model on unseen trials, by precision as the noise floor is; in older records under the other name."""
    return report[model].get("held_out_weighted_rms_m", report[model]["held_out_rms_m"])


def bias_removed(result):
    """Share of the error of the first bending stiffness that the extended model takes away; None: there was none."""
    for shift in result["report"].get("shifts", []):
        if "stiffness" not in shift["name"]:
            continue
        true = result["truth"]["constants"].get(shift["name"], 0.0) / result["truth"].get("mass_ratio", 1.0)
        if not true or abs(shift["before"] / true - 1.0) < LEAST_BIAS:
            return None
        return 1.0 - abs(shift["after"] - true) / abs(shift["before"] - true)
    return None


def is_right(kind, decision, truth):
    """Whether nothing counts against a decision."""
    bad = ("false_alarm", "confident_wrong")
    return all(value != (rate in bad) for rate, value in marks(kind, decision, truth).items())
