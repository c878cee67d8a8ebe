"""What the recordings of the pouch arm show by themselves, without a model: doc/real_arms.md's table of what the laws leave
unexplained. Used by plot_real_arms.py."""
import numpy as np

import real_regression

LAG_S, PASSED_PSI = 0.3, 3.5
ZERO_PSI = {"left": -0.75, "right": -0.01}  # of the sensors of segment 2 in `one_segment`, see its layout
ONE = {"no_load_1": "no_load/data_collect_1", "no_load_3": "no_load/data_collect_3", "load_1": "load_400g/data_collect_1",
       "load_3": "load_400g/data_collect_3"}


class Body:
    """A rigid body of a recording: place (mm; x towards the bend, y across it, z down) and tilt of its axis (rad)."""

    def __init__(self, rows, column):
        x, y, z = 1e3 * rows[:, column:column + 3].T
        self.place = np.column_stack([-x, y, -z])
        qx, qy, qz, qw = rows[:, column + 3:column + 7].T
        self.tilt = np.arctan2(2 * (qx * qz + qw * qy), 1 - 2 * (qx * qx + qy * qy))
        self.turned = 2 * (qx * qx + qy * qy) > 1  # upside down


class Recording:
    """One file: time (s), measured pressures of the two segments (psi), base, mid and tip."""

    def __init__(self, path):
        rows = np.genfromtxt(path, delimiter=",")
        self.time, self.psi = rows[:, 0], {1: rows[:, 4:7], 2: rows[:, 10:13]}
        self.base, self.mid, self.tip = Body(rows, 17), Body(rows, 24), Body(rows, 31)

    def mean(self, values, span):
        return values[(self.time >= span[0]) & (self.time < span[1])].mean(axis=0)

    def poses_per_second(self):
        return np.any(np.diff(self.tip.place, axis=0) != 0, axis=1).sum() / np.ptp(self.time)

    def scatter(self, span):
        """Of one sample of each pressure that is held: by second differences, without what the logger repeats."""
        held = (self.time >= span[0]) & (self.time < span[1])
        found = []
        for values in np.hstack([self.psi[1], self.psi[2]])[held].T:
            values = values[np.r_[True, np.diff(values) != 0]]
            found.append(np.sqrt(np.mean(np.diff(values, 2) ** 2) / 6) if len(values) > 20 else np.nan)
        return f"scatter of its pressure sensors {np.nanmin(found):.2f} to {np.nanmax(found):.2f} psi"


class Segment:
    """Between two bodies: vector and length of the chord, its angle, the change of tilt along it."""

    def __init__(self, upper, lower):
        self.vector = lower.place - upper.place
        self.length = np.linalg.norm(self.vector, axis=1)
        self.chord = np.arctan2(self.vector[:, 0], self.vector[:, 2])
        self.tilt = lower.tilt - upper.tilt


def one_segment(folder):
    print("\nthe recordings themselves, one segment: new poses a second; tilt of the tip, rad; its place, mm")
    slopes, largest = {}, []
    for trial, path in ONE.items():
        recording = Recording(folder / "one_segment" / f"{path}.txt")
        segment, mount = Segment(recording.mid, recording.tip), np.median(recording.mid.tilt)  # it does not move
        tilt, chord = recording.tip.tilt - mount, segment.chord - mount
        if trial == "no_load_1":
            print(f"  the mount leans by {mount:.3f} rad")
        before, inflated = (0.0, 0.5), (5.0, 5.7)
        place = {span: recording.mean(segment.vector, span) for span in (before, inflated, (11, 15))}
        print(f"  {trial:<10} {recording.poses_per_second():.0f} a second; tilt before {recording.mean(tilt, before):.3f}, at 5 s "
              f"{recording.mean(tilt, inflated):.3f}, at 11 s {recording.mean(tilt, (11, 15)):.3f}; towards the bend "
              f"{place[before][0]:.1f}, {place[inflated][0]:.1f}, {place[11, 15][0]:.1f}; across {place[before][1]:.1f}, "
              f"{place[inflated][1]:.1f}, {place[11, 15][1]:.1f}")
        off = recording.mean(tilt / 2 - chord, inflated)
        psi = recording.mean(recording.psi[2][:, 1], inflated) - ZERO_PSI["left"]
        slopes[trial] = recording.mean(tilt, inflated), psi
        largest.append(np.degrees(max(recording.mean(tilt, (s, s + 0.5)) for s in range(1, 29))))
        peak = max(range(15, 50), key=lambda k: recording.mean(segment.vector, (k / 10, k / 10 + 0.3))[0]) / 10
        lengths = ", ".join(f"{recording.mean(segment.length, (s, s + 0.7)):.1f}" for s in (2, 3, 4, 5))
        print(f"             half the tilt less the chord's angle {off:.3f} rad; farthest at {peak:.1f} s, by "
              f"{recording.mean(segment.vector, (peak, peak + 0.3))[0] - place[inflated][0]:.1f} mm more than at 5 s; "
              f"length at 2, 3, 4, 5 s {lengths} mm; pressure {psi:.1f} psi; "
              f"{recording.scatter((12, 28))}")
        if recording.time[-1] > 33:
            x = [recording.mean(segment.vector, span)[0] for span in ((29.5, 30.0), (33.5, 34.0))]
            print(f"             vented at 30 s: {x[0]:.1f} mm, after 4 s {x[1]:.1f} mm")
    for pair in (("no_load_1", "no_load_3"), ("load_1", "load_3")):
        (low, p_low), (high, p_high) = (slopes[trial] for trial in pair)
        print(f"  {' to '.join(pair)}: {(high - low) / (p_high - p_low):.3f} rad/psi between {p_low:.1f} and {p_high:.1f} psi")
    print(f"  largest tilt of each trial: {', '.join(f'{angle:.0f}' for angle in largest)} degrees")


def two_segments(folder):
    print("\nthe recordings themselves, two segments")
    for trial in ("no_load", "load_400g"):
        recording = Recording(folder / "two_segment" / trial / "data_collect_1.txt")
        upper, lower = Segment(recording.base, recording.mid), Segment(recording.mid, recording.tip)
        print(f"  {trial:<10} {recording.poses_per_second():.0f} poses a second; lengths before the first inflation "
              f"{recording.mean(upper.length, (0, 0.5)):.0f} + {recording.mean(lower.length, (0, 0.5)):.0f} mm, at 5 s "
              f"{recording.mean(upper.length, (5, 5.6)):.1f} + {recording.mean(lower.length, (5, 5.6)):.1f} mm, at 12 s "
              f"{recording.mean(upper.length, (12, 13)):.1f} + {recording.mean(lower.length, (12, 13)):.1f} mm; {recording.scatter((13, 28))}")
    for number in (1, 2, 3):
        recording = Recording(folder / f"steps/set_{number}/data_collect_1.txt")
        upper, lower = Segment(recording.base, recording.mid), Segment(recording.mid, recording.tip)
        print(f"  set_{number}      {recording.poses_per_second():.0f} poses a second; base turned in "
              f"{100 * recording.base.turned.mean():.0f} % of {len(recording.time)} rows; lengths at 18 s "
              f"{recording.mean(upper.length, (17, 19)):.0f} + {recording.mean(lower.length, (17, 19)):.0f} mm; {recording.scatter((5, 9))}")
        if number == 3:
            steps(recording, upper, lower)


def steps(recording, upper, lower):
    """One side driven alone: the base's tilt is 0, half of its rows are wrong."""
    low, high = (16, 19.5), (5, 9.5)
    tilt = {1: recording.mid.tilt, 2: lower.tilt}
    chord = {1: upper.chord, 2: lower.chord - recording.mid.tilt}
    for k in (1, 2):
        bend, line = (recording.mean(v[k], high) - recording.mean(v[k], low) for v in (tilt, chord))
        psi = [recording.mean(recording.psi[k][:, 1], span) for span in (low, high)]
        print(f"             segment {k}: {psi[0]:.1f} to {psi[1]:.1f} psi, tilt by {bend:.3f} rad ({bend / (psi[1] - psi[0]):.3f} "
              f"rad/psi), chord over tilt {line / bend:.2f} in differences, {recording.mean(chord[k], high) / recording.mean(tilt[k], high):.2f} "
              "at the high pressures")
    # Up from 0 and 20 s, down from 10 and 30 s: the tip on its way past one pressure, as read and through the pictures' lag.
    x = recording.tip.place[:, 0] - recording.base.place[:, 0]
    read = recording.psi[1][:, 1:2]
    print(f"             the tip held: {recording.mean(x, low):.0f} and {recording.mean(x, high):.0f} mm")
    for lag_s, psi in ((0, read[:, 0]), (LAG_S, real_regression.lagged(recording.time, read, LAG_S)[:, 0])):
        at = {}
        for start in (0, 10, 20, 30):
            some = np.flatnonzero((recording.time >= start + 0.1) & (recording.time < start + 9))
            up = start in (0, 20)
            at[start] = x[some[np.argmax((psi[some] > PASSED_PSI) == up)]]
        print(f"             passing {PASSED_PSI} psi, lag {lag_s} s: {at[0]:.0f} and {at[20]:.0f} mm up, {at[10]:.0f} and "
              f"{at[30]:.0f} mm down")


def print_facts(folder):
    one_segment(folder)
    two_segments(folder)
