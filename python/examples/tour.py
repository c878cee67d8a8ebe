# %% [markdown]
# # Python
#
# The module `softarm` offers the package's functions as Python objects and NumPy arrays: arm files, the model with its Jacobians,
# recordings and their checks, estimates, alarms, identification, diagnosis and the virtual rig. It runs the same code as the program
# `softarm`: tests keep the two equal to the last printed digit.
#
# ## Install
#
# From a checkout on Debian 12, `scripts/python` installs what is missing, builds the module, and runs Debian's `python3` with it:
#
# ```
# scripts/python -c 'import softarm; print(softarm.__version__)'
# scripts/softarm simulate demo --seconds 20 --out trial.bag
# scripts/python python/examples/estimate_trial.py trial.bag --out estimates.png
# ```
#
# In a catkin workspace the module is built with the package if pybind11 is installed (`apt-get install pybind11-dev
# python3-dev`). Otherwise CMake says in one line that it leaves the module out. Then
#
# ```
# source build/install/setup.bash
# python3 -c 'import softarm'
# ```
#
# The module belongs to `/usr/bin/python3`, as ROS's own modules do. It needs python3-numpy; `to_pandas()` also needs python3-pandas.
# `help(softarm)` and `help(softarm.Model.solve)` state shapes, units and errors. Editors complete names from the annotations, which
# mypy checks.
#
# ## Rules
#
# - SI units, and the unit in the name: `payload_kg`, `EI_nm2` (N m²), `stamp_s`.
# - An array's first axis counts instants. Axes of bodies, inputs and segments are in the order of `arm.bodies`, `arm.inputs`
#   and `arm.segments`.
# - NaN marks a value that is neither measured nor known. In `to_dict()` such a value is None.
# - Quaternions are x, y, z, w, as in ROS and SciPy.
# - Errors raise `softarm.Error` (`ArmError`, `BagError`, `CsvError`, `IdentifyError`), or `ValueError` for a wrong argument. The
#   message is the program's line.
# - Long calls let other threads run. Ctrl-C ends them. `progress=` takes a function of (share done, present step), which is
#   called in your thread.
#
# This page is [`python/examples/tour.py`](../python/examples/tour.py), executed by `scripts/python_page.py`. The notebook
# [`python/examples/tour.ipynb`](../python/examples/tour.ipynb) has the same cells and results. They use `trial.bag`, the recording of
# the [virtual rig](rig.md) made above.
#
# ## Arm files

# %%
import numpy as np
import matplotlib.pyplot as plt
import softarm

arm = softarm.load_arm("online_200mm")  # or the path of your own file
print(arm)
for body in arm.bodies:
    print(f"  {body.name}: {body.kind} at {body.arclength_m:.3f} m")
print("inputs:", ", ".join(f"{one.name} ({one.unit})" for one in arm.inputs))

# %% [markdown]
# `constants` holds the numbers of the laws, under the names that `identify` uses. An arm object never changes: another value makes
# another arm. Its text differs in that one value and keeps its comments.

# %%
for constant in list(arm.constants.values())[:4]:
    print(f"{constant.name} = {constant.value:.4g} {constant.unit}")
softer = arm.with_constants({"segment_1.bending_stiffness.base": 0.02})
changed = [line.strip() for line in softer.text.splitlines() if line not in arm.text.splitlines()]
print("changed:", changed)  # softer.save("softer.yaml") writes it

# %% [markdown]
# ## The model
#
# `Model` computes shapes from inputs and payload: by the laws of the arm file, the exact statics of the rod, and the file's effects.
# Inputs are given by name; those left out are 0.

# %%
model = softarm.Model(arm)
pressures_pa = np.linspace(0.0, 60e3, 7)
shapes = model.solve({"chamber_1": pressures_pa}, payload_kg=0.1, gravity_base_m_s2=[0.0, 0.0, 9.81])  # hanging
print("status:", *set(shapes.status), " backbone:", shapes.p_base_m.shape, " bodies:", shapes.bodies_p_base_m.shape)

figure, axes = plt.subplots(figsize=(7.0, 4.0))
for pressure_pa, p in zip(pressures_pa, shapes.p_base_m):
    axes.plot(1e3 * p[:, 2], 1e3 * p[:, 0], label=f"{1e-3 * pressure_pa:.0f} kPa")
axes.set(xlabel="z, down from the base (mm)", ylabel="x (mm)", title="chamber_1 inflated, hanging, 100 g at the tip", aspect="equal")
axes.legend(fontsize=8)
axes.grid(alpha=0.3)
figure.tight_layout()

# %% [markdown]
# Jacobians can be computed with the shapes: derivatives of the places of bodies and backbone by inputs, payload, gravity and
# constants of the laws. Here they bring the last ring to a given place in a few Gauss-Newton steps.

# %%
target_m = np.array([0.04, -0.02])  # x, y; z follows
chambers = [one.name for one in arm.inputs if one.kind == "pressure"][:3]
columns = [[one.name for one in arm.inputs].index(name) for name in chambers]
u = np.full(3, 20e3)
for step in range(4):
    at = model.solve(dict(zip(chambers, u)), 0.1, gravity_base_m_s2=[0.0, 0.0, 9.81], jacobians=True)
    miss = target_m - at.bodies_p_base_m[0, -1, :2]
    print(f"step {step}: {1e3 * np.linalg.norm(miss):.4f} mm off at {np.round(1e-3 * u, 2)} kPa")
    J = at.jacobians.bodies_by_inputs[0, -1, :2, columns].T
    u = u + np.linalg.pinv(J) @ miss

# %% [markdown]
# [Effects](effects.md) that `diagnose` wrote into an arm file act in the model as they do in an estimate. Each instant stands by
# itself, at rest. With `stamp_s` the instants become a trial, in which effects have a memory.
# `arm.effects` has their numbers and standard deviations, `arm.effects_correlations` how the errors of these go together.

# %%
effect = "effects:\n  - {id: hysteresis, parameters: {share: 0.3, width_pa: 2000, of: 0}}\n"
lagging = softarm.Model(softarm.parse_arm(arm.text + "\n" + effect))
print(*lagging.notes)
up_and_down_pa = np.concatenate([np.linspace(0.0, 40e3, 21), np.linspace(40e3, 0.0, 21)])
tip = lagging.solve({"chamber_1": up_and_down_pa}, stamp_s=0.1 * np.arange(42)).p_base_m[:, -1]
print(f"tip at 20 kPa, on the way down from where it was on the way up: {1e3 * np.linalg.norm(tip[31] - tip[10]):.2f} mm")

# %% [markdown]
# ## Recordings
#
# A trial is read for an arm, by the topics and units of its file. `read_csv` takes a CSV recording and a
# [layout](../config/layouts/template.yaml); `Trial.from_arrays` takes arrays. `softarm.simulate("demo", "trial.bag", seconds=20)`
# does what `softarm simulate` does. It takes scenarios, arms and dicts, and returns the truth as arrays.

# %%
trial = softarm.read_bag(arm, "trial.bag")
print(trial)
print("bodies:", trial.bodies_p_mocap_m.shape, "m;  inputs:", trial.inputs.shape, "Pa;  payloads:",
      sorted({float(one) for one in trial.payload_kg[~np.isnan(trial.payload_kg)]}), "kg")
table = trial.to_pandas()
table.index -= table.index[0]
print(table.iloc[:3, :4].round(5).to_string())

# %% [markdown]
# `check` returns what is wrong with the recording, and the remedies, as [`softarm check`](check.md) does:

# %%
checked = softarm.check(arm, "trial.bag")
print(checked, "serious:", checked.serious)
print(checked.to_pandas()[["severity", "id", "where", "figure", "unit"]].head(3).to_string())

# %% [markdown]
# ## Estimates
#
# `estimate` runs the node's estimator over a trial, with the options of `softarm estimate`. `identifiable_EI` says in which frames EI
# is well enough determined to be used.

# %%
found = softarm.estimate(trial)
print(found)
print(f"EI, where identifiable: {np.median(found.EI_nm2[found.identifiable_EI]):.4f} N m²")
print(f"rms residual: {1e3 * np.nanmean(found.rms_residual_m):.2f} mm")

time_s = found.stamp_s - found.stamp_s[0]
figure, (above, below) = plt.subplots(2, 1, figsize=(7.0, 4.4), sharex=True)
above.plot(time_s, np.degrees(found.theta_tip_rad))
above.set_ylabel("tip angle (°)")
EI, sd, good = found.EI_nm2[:, 0], found.sd_EI_nm2[:, 0], found.identifiable_EI[:, 0]
below.errorbar(time_s[good], EI[good], sd[good], fmt=".", ms=2, lw=0.4)
below.set(xlabel="time (s)", ylabel="EI (N m²)", ylim=(0.0, 2.0 * np.median(EI[good])))
figure.tight_layout()

# %% [markdown]
# `found.mismatch` holds the output of [the live monitor](mismatch.md) for every frame, `found.alarms` the sudden changes. Here the
# code moves one ring aside:

# %%
slipped_p_m = trial.bodies_p_mocap_m
slipped_p_m[time_s > 12.0, 2] += [0.0, 0.004, 0.0]
slipped = softarm.Trial.from_arrays(arm, trial.stamp_s, slipped_p_m, base_p_mocap_m=trial.base_p_mocap_m,
                                    base_q_mocap_xyzw=trial.base_q_mocap_xyzw, inputs=trial.inputs, payload_kg=trial.payload_kg)
print("before:", found.alarms)
for alarm in softarm.estimate(slipped).alarms:
    print(f"from {alarm.onset_s:.1f} s on: {alarm.description}")

# %% [markdown]
# `Estimator` takes frames one by one, as the node does. With `window_s` the frames of that time share EI and payload.

# %%
estimator = softarm.Estimator(arm, unknown="both", prior=True, window_s=0.5)
p, q, u = trial.bodies_p_mocap_m, trial.bodies_q_mocap_xyzw, trial.inputs
base_p, base_q = trial.base_p_mocap_m, trial.base_q_mocap_xyzw
for i in range(300):
    one = estimator.frame(trial.stamp_s[i], p[i], bodies_q_mocap_xyzw=q[i], base_p_mocap_m=base_p[i], base_q_mocap_xyzw=base_q[i],
                          inputs=u[i])
print(f"after 300 frames: EI {one.EI_nm2[0, 0]:.4f} ± {one.sd_EI_nm2[0, 0]:.4f} N m², "
      f"payload {1e3 * one.payload_kg[0]:.0f} ± {1e3 * one.sd_payload_kg[0]:.0f} g (there hung {1e3 * trial.payload_kg[299]:.0f} g)")

# %% [markdown]
# `softarm.estimate_bags(arm, paths)` takes many bags and works on several at a time. It does what `softarm estimate` does, at the same
# speed ([measured](benchmarks.md#from-python)).
#
# ## Constants, and what the arm file leaves out
#
# `identify` fits the constants to trials. `diagnose` looks for the physics that the arm file leaves out. Both take lists of trials and
# the options of the commands; the objects that they return hold what the commands write. Here one trial, cut in three, stands for the
# three or more that you record.

# %%
def part(k):
    chosen = slice(k * len(trial) // 3, (k + 1) * len(trial) // 3)
    return softarm.Trial.from_arrays(arm, trial.stamp_s[chosen], p[chosen], bodies_q_mocap_xyzw=q[chosen], base_p_mocap_m=base_p[chosen],
                                     base_q_mocap_xyzw=base_q[chosen], inputs=u[chosen], payload_kg=trial.payload_kg[chosen],
                                     name=f"part_{k + 1}")


result = softarm.identify(arm, [part(0), part(1), part(2)], moving=True)
print(result.verdict)
print(result.to_pandas()[["initial", "value", "sd", "unit", "determined"]].head(4).to_string())

# %% [markdown]
# The rig's arm swings, but the laws describe no swings. Other constants do not make up for that, and the verdict says so.
# `result.arm` is the arm with these constants; `result.arm.save("my_arm_identified.yaml")` writes it. `diagnose` is used in the same way:
#
# ```
# diagnosis = softarm.diagnose(arm, softarm.read_bags(arm, paths), progress=print)
# print(diagnosis.text)                  # what the program prints
# diagnosis.to_pandas()                  # every effect of the catalogue with its probability
# diagnosis.save("report")               # report.html, report.json, arm_extended.yaml
# softarm.Model(diagnosis.extended_arm)  # shapes with what was found
# softarm.estimate(trial, arm=diagnosis.extended_arm)
# ```
#
# ## Errors

# %%
for wrong in (lambda: softarm.load_arm("my_arm"), lambda: arm.with_constants({"segment_1.lenght": 0.2}),
              lambda: model.solve({"chamber_1": float("nan")}), lambda: softarm.read_bag(arm, "trials.bag")):
    try:
        wrong()
    except (softarm.Error, ValueError) as why:
        print(f"{type(why).__name__}: {why}")

# %% [markdown]
# ## Examples
#
# Three scripts to start from; each takes `--help`:
#
# | script | does |
# |---|---|
# | [`python/examples/estimate_trial.py`](../python/examples/estimate_trial.py) | turns bags into pictures and tables of estimates |
# | [`python/examples/reach.py`](../python/examples/reach.py) | finds the pressures that move the tip along a path, with the Jacobian |
# | [`python/examples/identify_and_diagnose.py`](../python/examples/identify_and_diagnose.py) | finds constants and left-out physics from trials; prints a table of each |
#
# The project's own plotting scripts use the module too: `scripts/plot_estimates.py`, `plot_check.py`, `plot_identify.py`,
# `plot_rig.py`, `plot_validation.py`, `plot_input_errors.py`.
