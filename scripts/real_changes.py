"""Known interventions on recordings of real arms: what is drawn, what it does to the tables, and what it should be called.

A change is a function of (kind of set, recordings, random) that alters the recordings and returns

    words       what was done, with its size, for people
    size, unit  how large it is
    effects     ids of the catalogue that say it outright; the others of its class are found by signature (prove_real.py)
    not         ids whose signatures are like it before the change, but which cannot make it good after (default: none)
    parameters  of these effects, where they follow from the size: {symbol: value}
    gravity     the arm file's gravity, in the cameras' axes (z up), where that is what is changed
    segment     the segment that has the constants of another session, where that is what is changed

or raises NothingChanged. Sizes are drawn from what nobody could see to what nobody could overlook.
"""
import bisect
import math

import prove_real_score

GRAVITY_M_S2 = 9.80665


class NothingChanged(Exception):
    """A draw that leaves the recordings as they were."""


def log_uniform(random, low, high):
    return low * (high / low) ** random.random()


def either(random):
    return random.choice((-1.0, 1.0))


# Vectors and quaternions (x, y, z, w) of plain numbers.
def add(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    norm = math.sqrt(dot(a, a))
    return tuple(x / norm for x in a)


def turn(axis, angle_rad):
    """The quaternion of a turn about a unit axis."""
    return (*(math.sin(0.5 * angle_rad) * x for x in axis), math.cos(0.5 * angle_rad))


def turned(quaternion, a):
    twice = tuple(2.0 * x for x in cross(quaternion[:3], a))
    return add(add(a, twice, quaternion[3]), cross(quaternion[:3], twice))


def product(p, q):
    """First q, then p."""
    vector = add(add(cross(p[:3], q[:3]), q[:3], p[3]), p[:3], q[3])
    return (*vector, p[3] * q[3] - dot(p[:3], q[:3]))


# What is told of the payload.
def loaded(recordings):
    return [one for one in recordings if any(kg > 0.0 for _, kg in one.payload)]


def told(kg):
    return lambda payload: [(start, kg(was)) for start, was in payload]


def payload_scaled(kind, recordings, random):
    share = log_uniform(random, 1.03, 2.0) ** either(random) - 1.0
    for one in recordings:
        one.payload = told(lambda was: (1.0 + share) * was)(one.payload)
    return {"words": f"payloads told at {1 + share:.2f} of what hung", "size": abs(share), "unit": "1",
            "effects": ["payload_scale", prove_real_score.TOLD_PAYLOADS], "parameters": {"share": share}}


# No share of what was told makes what hung of nothing, or of what hung elsewhere.
NO_SHARE = ["payload_scale"]


def payload_withheld(kind, recordings, random):
    some = loaded(recordings)
    some = [random.choice(some)] if random.random() < 0.5 else some
    for one in some:
        one.payload = told(lambda was: 0.0)(one.payload)
    kg = max(kg for one in some for _, kg in one.before.payload)
    return {"words": "payload told as none: " + ", ".join(one.name for one in some), "size": kg, "unit": "kg",
            "effects": [prove_real_score.TOLD_PAYLOADS], "not": NO_SHARE, "parameters": {}}


def payload_swapped(kind, recordings, random):
    a, b = random.sample(recordings, 2)
    hung = [max(kg for _, kg in one.payload) for one in (a, b)]
    if hung[0] == hung[1]:
        raise NothingChanged(f"{a.name} and {b.name} had the same payload")
    a.payload = told(lambda was: hung[1] if was > 0.0 or hung[0] == 0.0 else 0.0)(a.payload)
    b.payload = told(lambda was: hung[0] if was > 0.0 or hung[1] == 0.0 else 0.0)(b.payload)
    return {"words": f"payloads of {a.name} and {b.name} exchanged", "size": abs(hung[0] - hung[1]), "unit": "kg",
            "effects": [prove_real_score.TOLD_PAYLOADS], "not": NO_SHARE, "parameters": {}}


# Clocks.
def body_columns(kind):
    found = []
    for position, orientation in [*kind.bodies.values(), *([kind.base] if kind.base else [])]:
        found += range(position, position + 3)
        found += range(orientation, orientation + 4) if orientation is not None else []
    return found


def delay(kind, recording, columns, by_s):
    """Columns as they were by_s(t) before; rows for which that was before or after the recording go."""
    times = [kind.time_of(recording, i) for i in range(len(recording.rows))]
    source = recording.before.rows
    kept = []
    for i, row in enumerate(recording.rows):
        wanted = times[i] - by_s(times[i])
        if not times[0] <= wanted <= times[-1]:
            # Rows of a file without times are counted: they stay, their poses or inputs do not change any more.
            if kind.period_s is None:
                continue
            wanted = min(max(wanted, times[0]), times[-1])
        j = bisect.bisect_left(times, wanted)
        if j > 0 and (j == len(times) or wanted - times[j - 1] < times[j] - wanted):
            j -= 1
        for column in columns:
            row[column] = source[j][column]
        kept.append(row)
    recording.rows = kept


def clock_shifted(kind, recordings, random):
    by_s = log_uniform(random, 0.05, 2.0) * either(random)
    for one in recordings:
        delay(kind, one, body_columns(kind), lambda t: by_s)
    return {"words": f"the cameras' clock {1e3 * by_s:+.0f} ms", "size": abs(by_s), "unit": "s", "effects": ["clock_offset"],
            "parameters": {"offset_s": by_s}}


def clock_drifting(kind, recordings, random):
    rate = log_uniform(random, 0.001, 0.03) * either(random)
    for one in recordings:
        delay(kind, one, body_columns(kind), lambda t: rate * t)
    return {"words": f"the cameras' clock runs {100 * rate:+.2f} % off", "size": abs(rate), "unit": "1",
            "effects": ["clock_drift", "clock_offset"], "parameters": {"rate": rate}}


def input_clock_shifted(kind, recordings, random):
    by_s = log_uniform(random, 0.05, 2.0) * either(random)
    number = random.randrange(len(kind.inputs))
    for one in recordings:
        delay(kind, one, [kind.inputs[number]], lambda t: by_s)
    return {"words": f"the clock of input {number + 1} alone {1e3 * by_s:+.0f} ms", "size": abs(by_s), "unit": "s",
            "effects": ["clock_offset"], "parameters": {"offset_s": -by_s}}


# Where bodies are seen.
def place(row, column):
    return tuple(row[column:column + 3])


def tangents(kind, row):
    """Of each body, away from the base: by its orientation, or by chords of the bodies from the base on."""
    names = list(kind.bodies)
    if kind.base:
        return {name: turned(tuple(row[kind.bodies[name][1]:kind.bodies[name][1] + 4]), kind.down) for name in names}
    places = [kind.base_m, *(place(row, kind.bodies[name][0]) for name in names)]
    chords = [unit(add(b, a, -1.0)) for a, b in zip(places, places[1:])]
    found = {name: unit(add(a, b)) for name, a, b in zip(names, chords, chords[1:])}
    last = found[names[-2]] if len(names) > 1 else kind.down
    # An arc leaves its chord at the angle at which it came.
    found[names[-1]] = unit(add(tuple(2.0 * dot(chords[-1], last) * x for x in chords[-1]), last, -1.0))
    return found


def move_body(kind, recordings, name, across_m, along_m):
    """Along the arm, and towards the section's x, whose twist is taken for small."""
    column = kind.bodies[name][0]
    for one in recordings:
        for row in one.rows:
            tangent = tangents(kind, row)[name]
            across = unit(add(kind.across, tangent, -dot(kind.across, tangent)))
            row[column:column + 3] = add(add(place(row, column), tangent, along_m), across, across_m)


def body_moved_along(kind, recordings, random):
    name = random.choice(list(kind.bodies))
    by_m = log_uniform(random, 0.002, 0.02) * either(random)
    move_body(kind, recordings, name, 0.0, by_m)
    return {"words": f"{name} moved by {1e3 * by_m:+.1f} mm along the arm", "size": abs(by_m), "unit": "m",
            "effects": ["marker_slip"], "parameters": {"z_m": by_m}}


def body_moved_across(kind, recordings, random):
    name = random.choice(list(kind.bodies))
    by_m = log_uniform(random, 0.002, 0.02) * either(random)
    move_body(kind, recordings, name, by_m, 0.0)
    return {"words": f"{name} moved by {1e3 * by_m:+.1f} mm across the arm", "size": abs(by_m), "unit": "m",
            "effects": ["marker_slip"], "parameters": {"x_m": by_m}}


def bodies_exchanged(kind, recordings, random):
    first = random.randrange(len(kind.bodies) - 1)
    a, b = list(kind.bodies)[first:first + 2]
    some = [random.choice(recordings)] if random.random() < 0.5 else recordings
    for one in some:
        for row in one.rows:
            for begin, other, count in zip(kind.bodies[a], kind.bodies[b], (3, 4)):
                if begin is not None:
                    row[begin:begin + count], row[other:other + count] = row[other:other + count], row[begin:begin + count]
    where = "everywhere" if len(some) > 1 else f"in {some[0].name}"
    return {"words": f"{a} and {b} exchanged {where}", "size": len(some) / len(recordings), "unit": "1",
            "effects": [prove_real_score.EXCHANGED_NAMES],
            "parameters": {}}


# Frames. A tilt leads what hangs towards cos(azimuth) across + sin(azimuth) (down x across).
def tilt_of(kind, random):
    angle_rad, azimuth = math.radians(log_uniform(random, 0.5, 8.0)), 2.0 * math.pi * random.random()
    towards = add(tuple(math.cos(azimuth) * x for x in kind.across), cross(kind.down, kind.across), math.sin(azimuth))
    return angle_rad, azimuth, towards, turn(cross(kind.down, towards), angle_rad)


def in_cameras_axes(kind, vector):
    """x, y, z with z up, as the import writes them."""
    return (vector[0], -vector[2], vector[1]) if kind.down[1] != 0.0 else vector


def rotate_poses(kind, recordings, quaternion):
    """All that the cameras see, about the base (its place is not what is wrong)."""
    for one in recordings:
        for row in one.rows:
            pivot = kind.base_m or place(row, kind.base[0])
            for position, orientation in [*kind.bodies.values(), *([kind.base] if kind.base else [])]:
                row[position:position + 3] = add(pivot, turned(quaternion, add(place(row, position), pivot, -1.0)))
                if orientation is not None:
                    row[orientation:orientation + 4] = product(quaternion, tuple(row[orientation:orientation + 4]))


def words_of_tilt(angle_rad, azimuth):
    return f"{math.degrees(angle_rad):.1f} deg towards {math.degrees(azimuth):.0f} deg"


def frame_tilted(kind, recordings, random):
    angle_rad, azimuth, towards, quaternion = tilt_of(kind, random)
    rotate_poses(kind, recordings, quaternion)
    x, y, _ = in_cameras_axes(kind, towards)
    of_gravity = {"towards_x_rad": angle_rad * x, "towards_y_rad": angle_rad * y}
    return {"words": f"the cameras' frame tilted by {words_of_tilt(angle_rad, azimuth)}, gravity with it", "size": angle_rad,
            "unit": "rad", "effects": ["gravity_direction"] if kind.base else ["base_tilt", "gravity_direction"],
            "parameters": of_gravity if kind.base else {}}


def base_tilted(kind, recordings, random):
    angle_rad, azimuth, towards, quaternion = tilt_of(kind, random)
    found = {"words": f"the base's axes tilted by {words_of_tilt(angle_rad, azimuth)}, gravity not with them", "size": angle_rad,
             "unit": "rad", "effects": ["base_tilt"]}
    # A base whose own axes are turned sees the arm turned the other way; one that the file states does not turn with the poses.
    sign = -1.0 if kind.base else 1.0
    found["parameters"] = {"towards_x_rad": sign * angle_rad * math.cos(azimuth), "towards_y_rad": sign * angle_rad * math.sin(azimuth)}
    if not kind.base:
        rotate_poses(kind, recordings, quaternion)
        found["gravity"] = [GRAVITY_M_S2 * x for x in in_cameras_axes(kind, turned(quaternion, kind.down))]
        return found
    orientation = kind.base[1]
    for one in recordings:
        for row in one.rows:
            row[orientation:orientation + 4] = product(quaternion, tuple(row[orientation:orientation + 4]))
    return found


def gravity_tilted(kind, recordings, random):
    angle_rad, azimuth, towards, quaternion = tilt_of(kind, random)
    x, y, _ = in_cameras_axes(kind, towards)
    return {"words": f"gravity told tilted by {words_of_tilt(angle_rad, azimuth)}", "size": angle_rad, "unit": "rad",
            "effects": ["gravity_direction"], "parameters": {"towards_x_rad": -angle_rad * x, "towards_y_rad": -angle_rad * y},
            "gravity": [GRAVITY_M_S2 * c for c in in_cameras_axes(kind, turned(quaternion, kind.down))]}


# The log of the inputs. What the arm got stays as it was.
def span(kind, recordings, number):
    """How far an input goes: only 1 of 20 values lies beyond."""
    values = sorted(abs(row[kind.inputs[number]] - kind.zeros[number]) for one in recordings for row in one.rows)
    return values[int(0.95 * len(values))]


def numbers_of(kind, recordings, random):
    """Numbers of the inputs whose log is passed through something: all, or one that goes somewhere."""
    if random.random() < 0.6:
        return list(range(len(kind.inputs)))
    widths = [span(kind, recordings, n) for n in range(len(kind.inputs))]
    return [random.choice([n for n, width in enumerate(widths) if width > 0.1 * max(widths)])]


def which(kind, numbers):
    return "all inputs" if len(numbers) == len(kind.inputs) else f"input {numbers[0] + 1}"


def pass_log(kind, recordings, numbers, law):
    """law(number) makes a function of (t, value) that may remember."""
    for one in recordings:
        for number in numbers:
            column, zero, through = kind.inputs[number], kind.zeros[number], law(number)
            for i, row in enumerate(one.rows):
                row[column] = zero + through(kind.time_of(one, i), row[column] - zero)


def log_saturates(kind, recordings, random):
    numbers, share = numbers_of(kind, recordings, random), log_uniform(random, 0.02, 1.0)
    widths = [span(kind, recordings, n) for n in range(len(kind.inputs))]
    pass_log(kind, recordings, numbers, lambda n: lambda t, x: x / (1.0 + share * abs(x) / widths[n]))
    return {"words": f"log of {which(kind, numbers)} saturates, at full span {100 * share / (1 + share):.0f} % too low",
            "size": share / (1.0 + share), "unit": "1", "effects": ["gain_nonlinearity"] if kind.input_unit == "psi" else [],
            "parameters": {}}


def log_dead_zone(kind, recordings, random):
    numbers, share = numbers_of(kind, recordings, random), log_uniform(random, 0.01, 0.3)
    widths = [span(kind, recordings, n) for n in range(len(kind.inputs))]
    pass_log(kind, recordings, numbers, lambda n: lambda t, x: math.copysign(max(0.0, abs(x) - share * widths[n]), x))
    return {"words": f"log of {which(kind, numbers)} lacks the first {100 * share:.0f} % of the span", "size": share, "unit": "1",
            "effects": [], "parameters": {}}


def lag_law(time_s):
    state = {}

    def through(t, x):
        if not state:
            state.update(t=t, y=x)
        step = max(0.0, t - state["t"])
        state["y"] += (1.0 - math.exp(-step / time_s)) * (x - state["y"])
        state["t"] = t
        return state["y"]

    return through


def log_lags(kind, recordings, random):
    numbers, time_s = numbers_of(kind, recordings, random), log_uniform(random, 0.05, 2.0)
    pass_log(kind, recordings, numbers, lambda n: lag_law(time_s))
    return {"words": f"log of {which(kind, numbers)} lags with {time_s:.2f} s", "size": time_s, "unit": "s",
            "effects": ["clock_offset"] if len(numbers) > 1 else [], "parameters": {}}


def log_offset(kind, recordings, random):
    numbers, share = numbers_of(kind, recordings, random), log_uniform(random, 0.01, 0.3) * either(random)
    widths = [span(kind, recordings, n) for n in range(len(kind.inputs))]
    pass_log(kind, recordings, numbers, lambda n: lambda t, x: x + share * widths[n])
    return {"words": f"log of {which(kind, numbers)} off by {100 * share:+.0f} % of the span", "size": abs(share), "unit": "1",
            "effects": ["pressure_offset"] if kind.input_unit == "psi" else ["rest_curvature"], "parameters": {}}


def play_law(half):
    state = []

    def through(t, x):
        state[:] = [min(max(state[0] if state else x, x - half), x + half)]
        return state[0]

    return through


def log_plays(kind, recordings, random):
    numbers, share = numbers_of(kind, recordings, random), log_uniform(random, 0.02, 0.5)
    widths = [span(kind, recordings, n) for n in range(len(kind.inputs))]
    pass_log(kind, recordings, numbers, lambda n: play_law(0.5 * share * widths[n]))
    return {"words": f"log of {which(kind, numbers)} through a play of {100 * share:.0f} % of the span", "size": share, "unit": "1",
            "effects": ["hysteresis"], "parameters": {}}


def log_leaks(kind, recordings, random):
    numbers, share = numbers_of(kind, recordings, random), log_uniform(random, 0.02, 0.5)
    time_s = log_uniform(random, 2.0, 20.0)

    def law(number):
        slow = lag_law(time_s)
        return lambda t, x: x - share * slow(t, x)

    pass_log(kind, recordings, numbers, law)
    return {"words": f"log of {which(kind, numbers)} leaks {100 * share:.0f} % with {time_s:.1f} s", "size": share, "unit": "1",
            "effects": ["pressure_leak"] if kind.input_unit == "psi" else [], "parameters": {}}


def segment_of_another(kind, recordings, random):
    segment = random.choice(kind.segments)
    return {"words": f"{segment} has the constants of another session", "size": 1.0, "unit": "1", "effects": [], "parameters": {},
            "segment": segment}


COMMON = [payload_scaled, payload_withheld, payload_swapped, clock_shifted, clock_drifting, input_clock_shifted, body_moved_along,
          body_moved_across, frame_tilted, base_tilted, log_saturates, log_dead_zone, log_lags, log_offset, log_plays]
CHANGES = {"trunk": [*COMMON, bodies_exchanged, gravity_tilted, segment_of_another],
           "pouch_one": [*COMMON, log_leaks], "pouch_two": [*COMMON, log_leaks, bodies_exchanged, segment_of_another]}


def apply(name, kind, recordings, change, random):
    """(changed copies, what was done)."""
    copies = []
    for one in recordings:
        copies.append(one.changed())
        copies[-1].before = one
    done = next(c for c in CHANGES[name] if c.__name__ == change)(kind, copies, random)
    return copies, {"gravity": None, "segment": None, "not": [], **done}
