"""A picture of how far the proof's statements are to be believed: stated probabilities against what was right, and where the
true numbers lie in the stated intervals; and how often what is hidden is found, by its size."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import prove_figures as figures  # noqa: E402
import prove_score as score  # noqa: E402

RANK_BINS = 10


def draw_power(results, axis):
    """By world how often one thing that is hidden is named first, or in the class of that, over what it leaves: of all cases."""
    for number, (world, kinds) in enumerate(figures.WORLDS.items()):
        pairs = [(r, score.decision_of(r)) for r in results if r["truth"] and r["kind"] in kinds.values()]
        bins = figures.power(pairs)
        if not bins:
            continue
        rates = [100 * one["right_class"] for one in bins]
        ends = [figures.interval(round(one["right_class"] * one["trials"]), one["trials"]) for one in bins]
        axis.errorbar([1e3 * one["leftover_m"] * 1.03 ** number for one in bins], rates, fmt="o-", capsize=3, linewidth=1,
                      yerr=[[max(0, rate - 100 * end[0]) for rate, end in zip(rates, ends)],
                            [max(0, 100 * end[1] - rate) for rate, end in zip(rates, ends)]],
                      label=f"{world} ({sum(one['trials'] for one in bins)})")
    axis.set_xscale("log")
    axis.set(ylim=(-3, 106), xlabel="what it leaves beside the arm's constants, mm (rms)", ylabel="found, or its class, %",
             title="one thing hidden, clear or not (bars: 90 %)")
    if axis.lines:
        axis.legend(loc="lower right", frameon=False)


def draw(results, path):
    """results as prove_figures.figures() takes them."""
    pairs = [(r, score.decision_of(r)) for r in results if r["truth"] and r["report"]]
    statements = figures.stated(pairs)
    ranks = [rank for result, _ in pairs for rank in score.ranks(result)]
    figure, (left, right, last) = plt.subplots(1, 3, figsize=(14.5, 4.2), constrained_layout=True)
    left.plot([0, 100], [0, 100], color="0.7", linewidth=1)
    for of_bin in figures.calibration_bins(statements):
        if not of_bin:
            continue
        hits = sum(bool(hit) for _, hit in of_bin)
        low, high = figures.interval(hits, len(of_bin))
        x, y = 100 * figures.mean([p for p, _ in of_bin]), 100 * hits / len(of_bin)
        left.errorbar([x], [y], [[max(0, y - 100 * low)], [max(0, 100 * high - y)]], fmt="o", color="C0", capsize=3)
        to_right = x < 50
        left.annotate(f"{hits} of {len(of_bin)}", (x, y), xytext=(8 if to_right else -8, 0), textcoords="offset points",
                      ha="left" if to_right else "right", va="center", fontsize=9)
    left.set(xlim=(-3, 106), ylim=(0, 106), xlabel="stated probability of what is named, %", ylabel="it, or its class, is there, %",
             title=f"{len(statements)} statements in {len(pairs)} cases (bars: 90 %)")
    right.hist(ranks, bins=RANK_BINS, range=(0, 1), color="C0", rwidth=0.9)
    if ranks:
        even = len(ranks) / RANK_BINS
        spread = score.INTERVAL_SD * (even * (1 - 1 / RANK_BINS)) ** 0.5
        right.axhspan(max(0, even - spread), even + spread, color="0.85", zorder=0, label="even, 90 %")
        right.legend(loc="upper center")
        right.set_ylim(0, 1.25 * right.get_ylim()[1])  # the legend stands above the bars
    right.set(xlim=(0, 1), xlabel="rank of the true number in what is said of it", ylabel="numbers",
              title=f"{len(ranks)} numbers of effects that are there")
    draw_power(results, last)
    figure.savefig(path, dpi=110)
    plt.close(figure)
