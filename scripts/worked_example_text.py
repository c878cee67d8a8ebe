"""The text of doc/worked_example.md, around what the program said."""
import statistics

EI = "segment_1.bending_stiffness.base"


def wrapped(text, width=126):
    """Paragraphs as the tree's pages have them; tables, lists of code and empty lines are left alone."""
    import textwrap
    out, code = [], False
    for block in text.split("\n"):
        if block.startswith("```"):
            code = not code
        if code or block.startswith(("|", "```", "#", "!")) or len(block) <= width:
            out.append(block)
        else:
            indent = "  " if block.startswith("- ") else ""
            out += textwrap.wrap(block, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return "\n".join(out)


def frames_table(found):
    attitudes = ("hanging", "horizontal", "standing")
    speeds = ("slow", "slow", "slow", "medium", "medium", "medium", "fast", "fast", "fast")
    rows = ["| trial | | EI of its frames, median | residual |", "|---|---|---|---|"]
    for i, (name, frame) in enumerate(sorted(found["frames"].items())):
        rows.append(f"| {name} | {attitudes[i % 3]}, {speeds[i % 9]} | {1e3 * frame['EI']:.2f} mN m² | "
                    f"{1e3 * frame['residual']:.2f} mm |")
    return "\n".join(rows)


def page(found, steps, lines, percent):
    report, truth = found["report"], found["truth"]
    shift = next(s for s in report["shifts"] if s["name"] == EI)
    gain = next(s for s in report["shifts"] if s["name"].endswith("chamber_1.moment_gain"))
    value = report["effects"][0]["parameters"]["compliance_rad_per_nm"]
    before, after = report["baseline"]["held_out_weighted_rms_m"], report["extended"]["held_out_weighted_rms_m"]
    residual = statistics.median(f["residual"] for f in found["frames"].values())
    frame_error = 100 * statistics.median(f["error"] for f in found["frames"].values())
    covered = value["low"] <= truth["compliance"] <= value["high"]
    half = 1.645 * shift["sd_after"]
    estimate = "\n".join(found["estimate"].split("\n\n")[0].splitlines())
    extended = ""
    if found["extended"]:
        frame_after = 100 * statistics.median(f["error"] for f in found["after_frames"].values())
        residual_after = statistics.median(f["residual"] for f in found["after_frames"].values())
        extended = f"""
## 5. Use it

`report/arm_extended.yaml` is the arm file with the yielding base in it. The estimator and the node load it like any other:

```
$ softarm estimate --arm report/arm_extended.yaml campaign/case_001/*.bag --out estimates_extended
{lines(found["extended"].split(chr(10) + chr(10))[0], "^bag", "rms residual", "reduced chi-square, median", "^EI, median")}
```

The truth of each instant is known (EI depends on the pressures). Against it, the median error of EI of single frames is now {frame_after:+.1f} %; it was {frame_error:+.1f} %. The residuals of the frames fall from {1e3 * residual:.2f} to {1e3 * residual_after:.2f} mm.
"""
    text = f"""# A worked example: a base that yields

The clamp of this arm yields a little. Nobody sees it, because the body `base`, which the cameras follow, sits on the part that does not move. A fit gives results that look good and are wrong. This page shows how the fault is found, step by step, on the virtual rig, where the truth can be looked up at the end.

This page is the output of `scripts/worked_example`: every figure and every line of program output below is from that run. Where it says `softarm`, type `scripts/softarm`.

## 1. Record

Record nine trials of 30 s: three speeds, three mountings, without payload and with. This is the recipe of [diagnose](diagnose.md). A laboratory records the trials on its arm; here the virtual rig does ([the campaign](../config/campaigns/worked_example.yaml)):

```
$ softarm campaign worked_example --cases 1 --seed 1 --out campaign
```

What is hidden in the arm lies sealed in `campaign/truth/`. No step reads it before section 4.

## 2. Fit: plausible, and wrong

```
$ softarm identify --arm online_200mm campaign/case_001/*.bag --leave-one-out --out my_arm.yaml
{lines(found["identify"], "^constant ", "^segment.*moment_gain", "^segment.*bending_stiffness", "^shape error", "fitted trials, after")}
```

Every constant is identifiable, EI and gains to a per cent or better. The shape is predicted to about a per cent of the length; published models of such arms leave two to five. Next, the frames are fitted one by one with that arm file, EI being unknown:

```
$ softarm estimate --arm my_arm.yaml campaign/case_001/*.bag --out estimates
{lines(estimate, "^bag", "^frames ok", "rms residual", "reduced chi-square, median", "^EI, median", "identifiable in")}
```

The residuals are {1e3 * residual:.2f} mm, the median of the table below. The noise alone (0.5 mm per coordinate) makes some 0.8 mm, so they show nothing. Nor does EI give the fault away at a glance: it varies by some per cent, as measured stiffnesses do:

{frames_table(found)}

## 3. Diagnose

```
$ softarm diagnose --arm my_arm.yaml campaign/case_001/*.bag --out report
{found["diagnose"].rstrip()}
```

The diagnosis took {steps.seconds["diagnose"]:.0f} s here. Read it from the top:

- **Verdict.** Its figures are mean distances. As rms, in which the more precise means of frames count more, the error on trials that the fit has not seen falls, with the named effect, from {1e3 * before:.2f} to {1e3 * after:.2f} mm. One set of constants must serve all mountings, speeds and payloads at once. This is why the error without the effect is {1e3 * before:.2f} mm, which no single frame shows.
- **collinearity** ({100 * report["ranking"][0]["collinearity"]:.0f} % in the list of candidates): this share of what a yielding base does looks like a softer arm. The rest gives it away: the turn sits at the base, before the first ring, and grows with the moment there.
- **Estimates before, and with this**: how much EI and the gains are corrected.
- **mistaken for**: a spring at the base has rivals (clamped ends, shear). Other trials than these might leave them open, and they would be listed here.

![The report](images/worked_example_report.png)

## 4. The truth

Now the seal is opened (`campaign/truth/case_001/trial_01.truth.yaml`):

| | truth | without it in the model | with it |
|---|---|---|---|
| compliance of the base | {truth["compliance"]:.4f} rad/(N m) | none | {value["value"]:.4f}, 90 % interval {value["low"]:.4f} to {value["high"]:.4f} ({"holds the truth" if covered else "does not hold the truth"}) |
| EI, all trials together | {1e3 * truth["EI"]:.3f} mN m² | {1e3 * shift["before"]:.3f} ({percent(shift["before"], truth["EI"])}); `identify`: {1e3 * found["identified"]:.3f} ({percent(found["identified"], truth["EI"])}) | {1e3 * shift["after"]:.3f} ± {1e3 * half:.3f} ({percent(shift["after"], truth["EI"])}) |
| gain of chamber 1 | {1e6 * truth["gain"]:.3f} mN m/kPa | {1e6 * gain["before"]:.3f} ({percent(gain["before"], truth["gain"])}) | {1e6 * gain["after"]:.3f} ({percent(gain["after"], truth["gain"])}) |
| rms error on unseen trials | noise alone {1e3 * report["noise_floor_m"]:.2f} mm | {1e3 * before:.2f} mm | {1e3 * after:.2f} mm |

![Before and after](images/worked_example.png)

The left panel shows the median and the quartiles of the error of EI, over the frames in which EI is identifiable.{' The verdict says that something is left. This rest is no larger than the noise, but not white; it hides nothing of the size of a millimetre.' if report['verdict'] == 'partly_explained' and report['residual_structure']['chi2_per_dof'] < 1.2 else ''}

The intervals of `identify` and of single frames came from noise and residuals alone. They could not know what the model lacks.
{extended}
## On your own arm

```
scripts/softarm check --arm my_arm.yaml trials/*.bag         # is the recording sound?
scripts/softarm diagnose --arm my_arm.yaml trials/*.bag --out report
```

See also [how the diagnosis works, and what the report says](diagnose.md), and [what it makes of recordings of real arms](real_arms.md), where things are less tidy.
"""
    return wrapped(text)
