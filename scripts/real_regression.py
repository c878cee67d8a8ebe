"""A black-box regression of inputs and their past to places of the bodies, judged as the physics is: on whole sequences that
it has not seen. Used by plot_real_arms.py and plot_real_trunk.py; wants python3-sklearn."""
import numpy as np
from sklearn.ensemble import ExtraTreesRegressor
from sklearn.kernel_ridge import KernelRidge
from sklearn.linear_model import Ridge
from sklearn.model_selection import GridSearchCV, GroupKFold
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from softarm_module import rows_of

SEED = 1
FOLDS = 5
LEARNERS = {
    "linear (ridge)": (make_pipeline(StandardScaler(), Ridge()), {"ridge__alpha": 10.0 ** np.arange(-1, 7)}),
    "smooth (kernel ridge)": (make_pipeline(StandardScaler(), KernelRidge(kernel="rbf")),
                              {"kernelridge__alpha": [1e-2, 1e-1, 1], "kernelridge__gamma": [1e-3, 3e-3, 1e-2, 3e-2]}),
    "trees": (ExtraTreesRegressor(100, random_state=SEED), {"min_samples_leaf": [5, 20]}),
}


class Sequence:
    """One trial of a shapes.csv: time (s), payload and inputs per frame; places of the bodies (mm), three columns each."""

    def __init__(self, frames, bodies, inputs):
        stamps = sorted(stamp for stamp, rows in frames.items() if len(rows) == len(bodies))
        first = [frames[stamp][bodies[0]] for stamp in stamps]
        self.time = np.array(stamps)
        self.payload = np.array([[float(row["payload"])] for row in first])
        self.inputs = np.array([[float(row[name]) for name in inputs] for row in first])
        self.measured, self.predicted = (
            1e3 * np.array([[float(frames[stamp][body][f"{what}_{axis}"]) for body in bodies for axis in "xyz"]
                            for stamp in stamps]) for what in ("measured", "after"))

    def features(self, lags_s):
        """Inputs and their past, as they are and times the payload."""
        past = np.hstack([self.inputs] + [lagged(self.time, self.inputs, lag) for lag in lags_s])
        return np.hstack([self.payload, past, self.payload * past])


def sequences_of(path):
    """The trials of a shapes.csv by name."""
    trials, rows = {}, rows_of(path)
    names = list(rows[0])
    inputs = names[names.index("payload") + 1:names.index("body")]
    for row in rows:
        trials.setdefault(row["trial"], {}).setdefault(row["stamp"], {})[row["body"]] = row
    bodies = sorted({body for frames in trials.values() for rows in frames.values() for body in rows})
    return {name: Sequence(frames, bodies, inputs) for name, frames in trials.items()}


def lagged(time, values, lag_s):
    """Through a first-order lag that starts settled: a trial does not know what came before it."""
    out = values.copy()
    for i in range(1, len(time)):
        out[i] = values[i] + (out[i - 1] - values[i]) * np.exp((time[i - 1] - time[i]) / lag_s)
    return out


def distances(off):
    """Mean distance of the bodies of each frame."""
    return np.linalg.norm(off.reshape(len(off), -1, 3), axis=2).mean(axis=1)


def predict(sequences, unseen, lags_s, step=1):
    """Places of the bodies in the trials `unseen`, learnt from every step-th frame of the others: a dictionary of learner and
    trial. What a learner has to choose it chooses by trials that are left out in their turn (of one trial: stretches)."""
    seen = [name for name in sequences if name not in unseen]
    features = {name: sequence.features(lags_s) for name, sequence in sequences.items()}
    x = np.vstack([features[name][::step] for name in seen])
    y = np.vstack([sequences[name].measured[::step] for name in seen])
    groups = np.concatenate([np.full(len(features[name][::step]), i) for i, name in enumerate(seen)])
    if len(seen) == 1:
        groups = np.arange(len(x)) * FOLDS // len(x)
    folds = list(GroupKFold(min(FOLDS, len(set(groups)))).split(x, y, groups))
    found = {}
    for learner, (model, choices) in LEARNERS.items():
        search = GridSearchCV(model, choices, cv=folds, scoring="neg_mean_squared_error").fit(x, y - y.mean(axis=0))
        for name in unseen:
            found[learner, name] = search.predict(features[name]) + y.mean(axis=0)
    return found


def errors(sequences, unseen, lags_s, judged=None, step=1):
    """Mean distance (mm) in each unseen trial by the physics and by each learner, over the frames `judged` (a dictionary of
    trial and stamps; None: all)."""
    found = predict(sequences, unseen, lags_s, step)
    table = {}
    for name in unseen:
        sequence = sequences[name]
        take = slice(None) if judged is None else np.isin(sequence.time, judged[name])
        table[name] = {"physics": distances((sequence.predicted - sequence.measured)[take]).mean()}
        for learner in LEARNERS:
            table[name][learner] = distances((found[learner, name] - sequence.measured)[take]).mean()
    return table


def print_errors(title, table, rows):
    """One line per trial; then, as the page has them, rows of groups of trials: title, what is to be reached, the groups."""
    print(f"\n{title}: mean distance of the bodies in unseen trials, mm")
    columns = ["physics", *LEARNERS]
    print("  " + " " * 12 + "   ".join(columns))
    for name, row in table.items():
        print(f"  {name:<12}" + "   ".join(f"{row[column]:>{len(column)}.1f}" for column in columns))
    print("\n| trials | to reach | " + " | ".join(columns) + " |\n" + "|---" * (2 + len(columns)) + "|")
    for name, reach, groups in rows:
        cells = [", ".join(f"{np.mean([table[trial][column] for trial in group]):.1f}" for group in groups) for column in columns]
        print(f"| {name} | {reach} | " + " | ".join(cells) + " |")
