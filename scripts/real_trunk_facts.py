"""What the recordings of the tendon trunk show by themselves, without a model of the arm: how fast it moves, what maps of the
angles leave, which motor bends what. Used by plot_real_trunk.py."""
import numpy as np

PERIOD_S = 0.01
ROWS = 15000  # with inputs: 150 s
PIECE = 1500
HELD_OUT = (2, 5, 8)
BASE = np.array([100.8, -104.5, 2.6])  # mm, see config/arms/tendon_trunk.yaml
BINS_HZ = 10
ORDER = (3, 5, 1, 6, 2, 4)  # motors, by the segment where their tendons end
PLAYS_DEG = (1, 2, 4, 8, 15, 30)


def discs_of(path):
    """Places of the three discs, mm: x, y level, z up, as in the bags."""
    rows = np.genfromtxt(path, delimiter=",", skip_header=1)
    return rows, 1e3 * rows[:, 1:10].reshape(-1, 3, 3)[:, :, [0, 2, 1]] * [1, -1, 1]


def reads_of(angles):
    """The angles as straight lines between the instants at which they were read."""
    read = np.r_[0, 1 + np.flatnonzero(np.abs(np.diff(angles, axis=0)).max(axis=1) > 0)]
    every = np.arange(len(angles))
    return len(read) / len(angles) / PERIOD_S, np.column_stack([np.interp(every, read, a[read]) for a in angles.T])


def smooth(values, half=15):
    """Running mean, twice over: 0.3 s."""
    kernel = np.convolve(np.ones(half) / half, np.ones(half) / half)
    kernel /= kernel.sum()
    pad = len(kernel) // 2
    return np.column_stack([np.convolve(np.pad(v, pad, "edge"), kernel, "valid") for v in values.T])


def play(angle, half_width):
    """What follows an angle with slack on either side."""
    out = np.empty_like(angle)
    at = angle[0]
    for i, a in enumerate(angle):
        at = min(max(at, a - half_width), a + half_width)
        out[i] = at
    return out


def left_on_held_out(features, tip, penalty=1e-4):
    """rms (x, y) of a linear map of the features on pieces 2, 5 and 8, learnt on the others."""
    piece = np.arange(len(tip)) // PIECE
    seen = ~np.isin(piece, HELD_OUT)
    mean, sd = features[seen].mean(axis=0), features[seen].std(axis=0)
    x, y0 = (features - mean) / sd, tip[seen].mean(axis=0)
    normal = x[seen].T @ x[seen] + penalty * seen.sum() * np.eye(x.shape[1])
    slopes = np.linalg.solve(normal, x[seen].T @ (tip[seen] - y0))
    return np.sqrt(((tip[~seen] - y0 - x[~seen] @ slopes) ** 2).mean(axis=0))


def print_maps(angles, tip):
    """What maps of the angles to the lowest disc leave."""
    even = smooth(angles)
    rate = np.gradient(even, PERIOD_S, axis=0)
    columns = range(angles.shape[1])
    scaled = (angles - angles.mean(axis=0)) / angles.std(axis=0)
    squares = [scaled[:, i] * scaled[:, j] for i in columns for j in columns if j >= i]
    cubes = [scaled[:, i] * scaled[:, j] * scaled[:, k] for i in columns for j in columns if j >= i for k in columns if k >= j]
    maps = {"linear": angles, "and speeds, accelerations": np.hstack([angles, rate, np.gradient(rate, PERIOD_S, axis=0)]),
            "of degree 3": np.column_stack([angles, *squares, *cubes])}
    text = ", ".join(f"{name} {' and '.join(f'{x:.1f}' for x in left_on_held_out(f, tip))}" for name, f in maps.items())
    print(f"         unseen pieces, rms in x and y: {text} mm")
    plays = {}
    for width in PLAYS_DEG:
        slack = np.column_stack([play(angles[:, i], np.radians(width)) for i in columns])
        plays[width] = left_on_held_out(np.hstack([angles, slack]), tip)
    print("         linear, and play of each angle: " + ", ".join(f"{width} degrees {left[0]:.1f} and {left[1]:.1f}"
                                                              for width, left in plays.items()) + " mm")


def print_speed(loads, data):
    """loads: name and file of each recording."""
    commands = np.genfromtxt(data / "control_inputs_controlled_1.csv", delimiter=",", skip_header=1)[:ROWS, 1:]
    print("\nthe recordings themselves: the lowest disc")
    for load, name in loads.items():
        rows, discs = discs_of(data / f"{name}.csv")
        per_second, angles = reads_of(np.radians(rows[:ROWS, 10:16]))
        tip = discs[:ROWS, 2, :2]
        off = tip - tip.mean(axis=0)
        frequency = np.fft.rfftfreq(ROWS, PERIOD_S)
        power = (np.abs(np.fft.rfft(off, axis=0)) ** 2).sum(axis=1)
        below = frequency[np.searchsorted(np.cumsum(power) / power.sum(), 0.99)]
        typical = np.sqrt((frequency ** 2 * power)[frequency < 5].sum() / power[frequency < 5].sum())
        one = np.column_stack([angles, np.ones(ROWS)])
        rest = tip - one @ np.linalg.lstsq(one, tip, rcond=None)[0]
        share = 1 - (rest ** 2).sum() / (off ** 2).sum()
        delay = [max(range(60), key=lambda d, k=k: np.corrcoef(commands[:ROWS - d, k], angles[d:, k])[0, 1]) for k in range(6)]
        acceleration = np.sqrt((off ** 2).mean()) * 1e-3 * (2 * np.pi * typical) ** 2
        print(f"  {load:<5}  moves by {off[:, 0].std():.0f} and {off[:, 1].std():.0f} mm (sd), 99 % of it below {below:.2f} Hz, "
              f"typical {typical:.2f} Hz: {acceleration:.1f} m/s^2; angles read {per_second:.0f} times a second, "
              f"{np.mean(delay) * PERIOD_S:.2f} s after the commands")
        print(f"         linear in the angles: {rest[:, 0].std():.1f} and {rest[:, 1].std():.1f} mm left, R2 {share:.2f}")
        print_maps(angles, tip)


def arcs(discs):
    """Curvatures (1/m) of arcs from the base, which hangs straight, through the discs: an array of segments and two directions
    that are carried along the arm without a twist: x, and -y, as z points down the arm."""
    tangent = np.tile([0.0, 0.0, -1.0], (len(discs), 1))
    first, second = (np.tile(v, (len(discs), 1)) for v in ([1.0, 0, 0], [0.0, -1, 0]))
    start, found = np.tile(BASE, (len(discs), 1)), []
    dot = lambda a, b: (a * b).sum(axis=1, keepdims=True)
    for k in range(3):
        chord = discs[:, k] - start
        square = dot(chord, chord)
        found.append(np.hstack([2e3 * dot(chord, v) / square for v in (first, second)]))
        # Half a turn about the chord, of which the tangent's and a mirror's two make the arc.
        unit = chord / np.sqrt(square)
        end = 2 * dot(tangent, unit) * unit - tangent
        turned = []
        for v in (first, second):
            half = tangent + end
            turned.append(v - dot(v, half) * half / (1 + dot(tangent, end)) + 2 * dot(v, tangent) * end)
        tangent, (first, second), start = end, turned, discs[:, k]
    return np.stack(found, axis=1)


def print_bending(name, data):
    """Which motor bends what: markdown rows of the page."""
    rows, discs = discs_of(data / f"{name}.csv")
    angles = reads_of(np.radians(rows[:ROWS, 10:16]))[1]
    bent = arcs(discs[:ROWS])
    one = np.column_stack([angles, np.ones(ROWS)])
    slopes = np.array([np.linalg.lstsq(one, bent[:, k], rcond=None)[0][:6] for k in range(3)])  # segment, motor, direction
    size, ends = np.linalg.norm(slopes, axis=2), {motor: i // 2 for i, motor in enumerate(ORDER)}
    print("\ncurvature of each segment by each motor, 1/m per rad")
    print("| | " + " | ".join(f"motor {motor}" for motor in ORDER) + " |\n" + "|---" * 7 + "|")
    towards = [slopes[ends[motor], motor - 1] for motor in ORDER]
    print("| direction where it ends | " + " | ".join(f"{np.degrees(np.arctan2(v[1], v[0])):.0f}°" for v in towards) + " |")
    for k in range(3):
        cells = []
        for motor, v in zip(ORDER, towards):
            cell = f"{size[k, motor - 1]:.1f}"
            cell = f"**{cell}**" if ends[motor] == k else cell
            back = slopes[k, motor - 1] @ v < -0.7 * size[k, motor - 1] * np.linalg.norm(v)
            cells.append(cell + (", back" if back else ""))
        print(f"| segment {k + 1} | " + " | ".join(cells) + " |")


def print_lengths(loads, data):
    """Distances of the discs: what stretch by the payload would change."""
    print("\nchord from disc 1 to 2 and from 2 to 3, mean, mm")
    for load, name in {**loads, "zeros": "observations_zeros_0g", "decay": "observations_manual_decay_200g"}.items():
        chords = np.linalg.norm(np.diff(discs_of(data / f"{name}.csv")[1], axis=1), axis=2).mean(axis=0)
        print(f"  {load:<6} {chords[0]:.1f}, {chords[1]:.1f}")


def print_facts(loads, data):
    print_speed(loads, data)
    print_bending(loads["0g"], data)
    print_lengths(loads, data)
