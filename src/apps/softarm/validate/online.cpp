// "Physics-Informed Online Estimation of Stiffness and Shape of Soft Robotic Manipulators", Tables I to III
// and the payload estimates of IV.C.
#include <fmt/format.h>
#include <time.h>

#include <cmath>
#include <functional>

#include "online_series.h"
#include "online_statistics.h"
#include "papers.h"
#include "softarm/arm/arm_file.h"
#include "softarm/estimate/estimator.h"

namespace softarm::app::validate {
namespace {

constexpr double kDeg = 180.0 / M_PI;

double percent(const OnlineFit& fit) {
  return fit.error_percent;
}

struct Runs {
  std::vector<std::string> names;
  std::vector<OnlineExperiment> experiments;

  std::vector<Cell> cells(const char* format,
                          const std::function<double(const OnlineExperiment&)>& value) const {
    std::vector<Cell> result;
    for (const OnlineExperiment& e : experiments) result.push_back(cell(format, value(e)));
    return result;
  }
};

Table table_2(const Runs& runs) {
  Table table{"online.table_2", "Table II: error of the shape, formula (7)", runs.names, {}, {}};
  struct Printed {
    const char *name, *mean, *max, *sd, *none;
  };
  constexpr std::array<Printed, 4> kTheirs{{{"full points", "2.94 %", "5.17 %", "0.68 %", "2.06 %"},
                                            {"end orientation", "5.47 %", "9.07 %", "1.49 %", "2.96 %"},
                                            {"CC all points", "6.84 %", "10.4 %", "2.05 %", "3.40 %"},
                                            {"CC end point", "7.70 %", "12.6 %", "2.55 %", "3.50 %"}}};
  for (std::size_t m = 0; m < kTheirs.size(); ++m) {
    const Printed& theirs = kTheirs[m];
    const OnlinePick pick = online_fit(m, kPrinted);
    const auto add = [&](const char* what, const char* published, const auto& value) {
      table.rows.push_back(
          {fmt::format("{}: {}", theirs.name, what), published, runs.cells("{:.2f} %", value), ""});
    };
    add("mean", theirs.mean,
        [&](const OnlineExperiment& e) { return summarise(e, Load::kLoaded, pick, percent).all.mean; });
    add("max", theirs.max,
        [&](const OnlineExperiment& e) { return summarise(e, Load::kLoaded, pick, percent).maximum; });
    add("std", theirs.sd,
        [&](const OnlineExperiment& e) { return summarise(e, Load::kLoaded, pick, percent).all.sd; });
    add("no load", theirs.none,
        [&](const OnlineExperiment& e) { return summarise(e, Load::kNone, pick, percent).all.mean; });
  }
  table.notes = {
      "Read as 100 sum over i = 1 ... 4 of |error_i| / (i L): (7) with its c_i = 1/(i L), a pure number. "
      "Points "
      "lie at i L/4, so it is the mean over the points of the error relative to their arclength. Mean, max "
      "and "
      "std over the loaded data sets; against measured points, as a laboratory must. Fitted as printed: sums "
      "of "
      "distances (7), (8), exact statics for the loads. Max: of one repeat of the 90 data sets, averaged "
      "over "
      "the repeats."};
  return table;
}

Table improvements(const Runs& runs) {
  Table table{"online.improvements", "IV.A: better than constant curvature", runs.names, {}, {}};
  const auto add = [&](const char* name, const char* published, std::size_t ours, std::size_t theirs,
                       const char* remark) {
    table.rows.push_back(
        {fmt::format("{}: of the means", name), published,
         runs.cells("{:.0f} %",
                    [&](const OnlineExperiment& e) {
                      const auto mean = [&](std::size_t m) {
                        return summarise(e, Load::kLoaded, online_fit(m, kPrinted), percent).all.mean;
                      };
                      return 100.0 * (1.0 - mean(ours) / mean(theirs));
                    }),
         remark});
    const auto each = [&](const OnlineExperiment& e, bool share) {
      std::vector<double> values;
      for (const OnlineSet& set : e) {
        for (const auto& frames : set.datasets) {
          for (const OnlineFrame& f : frames) {
            const OnlineFit &a = f.fits[ours][kPrinted], &b = f.fits[theirs][kPrinted];
            if (f.payload_kg <= 0.0 || !a.ok || !b.ok) continue;
            const double gain = 1.0 - a.error_percent / b.error_percent;
            values.push_back(100.0 * (share ? static_cast<double>(gain > 0.0) : gain));
          }
        }
      }
      return statistics(values).mean;
    };
    table.rows.push_back({fmt::format("{}: mean of each", name), "",
                          runs.cells("{:.0f} %", [&](const OnlineExperiment& e) { return each(e, false); }),
                          ""});
    table.rows.push_back({fmt::format("{}: better in", name), "100 %",
                          runs.cells("{:.1f} %", [&](const OnlineExperiment& e) { return each(e, true); }),
                          "of the loaded data sets"});
  };
  add("full points", "57 %", 0, 2, "1 - 2.94/6.84 = 57 %");
  add("end orientation", "41 %", 1, 3,
      "1 - 5.47/7.70 = 29 %: the printed 41 % does not follow from the printed means");
  return table;
}

Table table_3(const Runs& runs) {
  Table table{
      "online.table_3", "Table III: spread of EI over the payloads, equal pressures", runs.names, {}, {}};
  const auto add = [&](const std::string& name, const std::array<const char*, 3>& published,
                       const OnlinePick& pick, const std::string& remark) {
    const auto row = [&](const char* what, const char* theirs, const char* format, const std::string& why,
                         const std::function<double(const OnlineSpread&)>& value) {
      table.rows.push_back(
          {fmt::format("{}: {}", name, what), theirs,
           runs.cells(format, [&](const OnlineExperiment& e) { return value(spread(e, pick)); }), why});
    };
    row("mean std (mN m2)", published[0], "{:.1f}", remark,
        [](const OnlineSpread& s) { return 1e3 * s.sd_nm2.mean; });
    row("max std (mN m2)", published[1], "{:.1f}", "",
        [](const OnlineSpread& s) { return 1e3 * s.maximum_nm2; });
    row("relative std", published[2], "{:.2f} %", "",
        [](const OnlineSpread& s) { return 100.0 * s.relative.mean; });
    row("EI off the truth by", "", "{:+.1f} %", "mean over the loaded frames; only a rig knows it",
        [](const OnlineSpread& s) { return 100.0 * s.bias.mean; });
  };
  add("full points", {"2.9", "4.2", "7.71 %"}, online_fit(0, kPrinted),
      "printed as mN/(m2 rad); 2.9 / 7.71 % makes a mean EI of 37.6 mN m2");
  add("end orientation", {"6.7", "19.5", "17.76 %"}, online_fit(1, kPrinted), "");
  add("full, least squares", {"", "", ""}, online_fit(0, kSquares), "ours: squares weighted by the noise");
  add("end, least squares", {"", "", ""}, online_fit(1, kSquares), "");
  const OnlinePick printed = [](const OnlineFrame& f) -> const OnlineFit& { return f.printed; };
  table.rows.push_back(
      {"printed load moments: relative std", "",
       runs.cells("{:.2f} %",
                  [&](const OnlineExperiment& e) { return 100.0 * spread(e, printed).relative.median; }),
       "(2), (3) as printed instead of statics; full points, least squares; one repeat, median of "
       "the sets"});
  table.rows.push_back(
      {"printed load moments: EI off the truth by", "",
       runs.cells("{:+.1f} %",
                  [&](const OnlineExperiment& e) { return 100.0 * spread(e, printed).bias.median; }),
       "median"});
  table.rows.push_back({"printed load moments: shape, formula (7)", "",
                        runs.cells("{:.2f} %",
                                   [&](const OnlineExperiment& e) {
                                     return summarise(e, Load::kLoaded, printed, percent).all.median;
                                   }),
                        "median, against measured points: a good fit of the shape is no proof of EI"});
  return table;
}

Table payloads(const Runs& runs) {
  Table table{"online.payload",
              "IV.C: unseen weights of 140 ... 240 g, EI from the first data set",
              runs.names,
              {},
              {}};
  const auto add = [&](const char* name, std::size_t objective, bool published) {
    table.rows.push_back(
        {fmt::format("{}: mean error", name), published ? "9.7 g" : "",
         runs.cells("{:.1f} g",
                    [&](const OnlineExperiment& e) { return weighing(e, objective).grams.all.mean; }),
         ""});
    table.rows.push_back(
        {fmt::format("{}: max error", name), published ? "29.9 g" : "",
         runs.cells("{:.1f} g",
                    [&](const OnlineExperiment& e) { return weighing(e, objective).grams.maximum; }),
         ""});
    table.rows.push_back(
        {fmt::format("{}: mean error", name), published ? "4.97 %" : "",
         runs.cells("{:.2f} %", [&](const OnlineExperiment& e) { return weighing(e, objective).percent; }),
         ""});
  };
  add("sum of distances", kPrinted, true);
  add("least squares", kSquares, false);
  return table;
}

/// What the rig's truth says of one method.
void add_truth(Table& table, const Runs& runs, const char* name, const OnlinePick& pick) {
  const auto shape = [&](const OnlineExperiment& e) {
    return summarise(e, Load::kLoaded, pick, [](const OnlineFit& f) { return f.truth_percent; }).all.mean;
  };
  const auto tip = [&](const OnlineExperiment& e) {
    return summarise(e, Load::kLoaded, pick, [](const OnlineFit& f) { return f.tip_mm; }).all.mean;
  };
  table.rows.push_back({fmt::format("{}: shape against truth", name), "", runs.cells("{:.2f} %", shape),
                        "formula (7), true places of the points"});
  table.rows.push_back({fmt::format("{}: tip against truth", name), "", runs.cells("{:.2f} mm", tip), ""});
}

void add_identifiable(Table& table, const Runs& runs, const char* name, std::size_t method, Load load) {
  const auto share = [&](const OnlineExperiment& e) {
    return summarise(e, load, online_fit(method, kSquares),
                     [](const OnlineFit& f) { return f.identifiable ? 100.0 : 0.0; })
        .all.mean;
  };
  table.rows.push_back({fmt::format("{}: EI identifiable", name), "", runs.cells("{:.0f} %", share),
                        "frames that determine EI to a standard deviation of 25 %"});
}

double without_estimate_percent(const OnlineExperiment& e, std::size_t method) {
  std::vector<double> missing;
  for (const OnlineSet& set : e)
    for (const auto& frames : set.datasets)
      for (const OnlineFrame& f : frames) missing.push_back(f.fits[method][kPrinted].ok ? 0.0 : 100.0);
  return statistics(missing).mean;
}

/// Of the data sets' first frames.
std::vector<double> tip_angles_deg(const OnlineExperiment& e) {
  std::vector<double> angles;
  for (const OnlineSet& set : e)
    for (const auto& frames : set.datasets) angles.push_back(kDeg * frames.front().tip_angle_rad);
  return angles;
}

double moving_mm(const OnlineExperiment& e) {
  double most = 0.0;
  for (const OnlineSet& set : e) most = std::max(most, 1e3 * set.moving_m);
  return most;
}

Table additions(const Runs& runs) {
  Table table{"online.additions", "Beside the paper: what only a rig can show", runs.names, {}, {}};
  add_truth(table, runs, "full, sum of distances", online_fit(0, kPrinted));
  add_truth(table, runs, "full, least squares", online_fit(0, kSquares));
  add_truth(table, runs, "end, sum of distances", online_fit(1, kPrinted));
  add_truth(table, runs, "end, least squares", online_fit(1, kSquares));
  add_identifiable(table, runs, "full, loaded", 0, Load::kLoaded);
  add_identifiable(table, runs, "full, no load", 0, Load::kNone);
  add_identifiable(table, runs, "end, loaded", 1, Load::kLoaded);
  constexpr std::array<const char*, 4> kNames{"full points", "end orientation", "CC all points",
                                              "CC end point"};
  for (std::size_t m = 0; m < kNames.size(); ++m) {
    table.rows.push_back(
        {fmt::format("{}: no estimate", kNames[m]), "",
         runs.cells("{:.1f} %", [&](const OnlineExperiment& e) { return without_estimate_percent(e, m); }),
         m == 0 ? "of all frames, sum of distances; they are in no figure above" : ""});
  }
  const auto least = [](const OnlineExperiment& e) {
    double angle = 1e9;
    for (const double deg : tip_angles_deg(e)) angle = std::min(angle, deg);
    return angle;
  };
  const auto greatest = [](const OnlineExperiment& e) {
    double angle = 0.0;
    for (const double deg : tip_angles_deg(e)) angle = std::max(angle, deg);
    return angle;
  };
  table.rows.push_back({"tip angle, least", "", runs.cells("{:.0f} deg", least), ""});
  table.rows.push_back({"tip angle, greatest", "under 180 deg", runs.cells("{:.0f} deg", greatest), ""});
  table.rows.push_back({"still moving, at most", "", runs.cells("{:.3f} mm", moving_mm),
                        "a ring, while a data set was measured"});
  return table;
}

/// Of this thread: what else the machine does is not counted.
double cpu_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Seconds of one frame from nothing, in this thread alone.
Statistics times(const OnlineExperiment& sets, arm::Method method, arm::Objective objective) {
  const arm::Arm arm = shipped_arm("online_200mm");
  arm::EstimatorOptions options = arm.estimator;
  options.method = method;
  options.objective = objective;
  options.robust = objective == arm::Objective::kLeastSquares;  // as in the tables
  estimate::Estimator estimator(arm, options);
  std::vector<double> seconds;
  for (const OnlineSet& set : sets) {
    for (const auto& frames : set.datasets) {
      for (const OnlineFrame& f : frames) {
        estimator.reset();
        const double start = cpu_seconds();
        estimator.estimate(f.frame);
        seconds.push_back(cpu_seconds() - start);
      }
    }
  }
  return statistics(seconds);
}

Table table_1(const OnlineExperiment& sets) {
  Table table{
      "online.table_1", "Table I: processing time of one frame (s)", {"ours", "ours, least squares"}, {}, {}};
  const auto add = [&](const char* name, arm::Method method, const std::array<const char*, 3>& published) {
    const Statistics a = times(sets, method, arm::Objective::kSumOfDistances),
                     b = times(sets, method, arm::Objective::kLeastSquares);
    const auto row = [&](const char* what, const char* theirs, double x, double y,
                         const std::string& remark) {
      table.rows.push_back(
          {fmt::format("{}: {}", name, what), theirs, {cell("{:.6f}", x), cell("{:.6f}", y)}, remark});
    };
    row("mean", published[0], a.mean, b.mean, fmt::format("{} frames", a.count));
    row("max", published[1], a.maximum, b.maximum, "");
    row("std", published[2], a.sd, b.sd, "");
  };
  add("full points", arm::Method::kFullPoints, {"0.236", "0.776", "0.121"});
  add("end orientation", arm::Method::kEndOrientation, {"0.123", "0.342", "0.033"});
  add("CC all points", arm::Method::kCcPoints, {"0.025", "0.041", "0.005"});
  table.notes = {
      "Theirs: MATLAB's fmincon on an i5-7600K. Ours: this machine, processor time, every frame from nothing "
      "(no "
      "warm "
      "start), with covariances and 41 points of the backbone. Times differ from run to run."};
  return table;
}

}  // namespace

Result online(const Settings& settings, Progress& progress) {
  const int sets = settings.quick ? 5 : 15, repeats = settings.quick ? 2 : 5;
  std::vector<OnlineSetting> where;
  Runs runs;
  for (const OnlineSetting& setting : kOnlineSettings)
    if (setting.standing || !settings.quick) where.push_back(setting);
  for (const OnlineSetting& setting : where) {
    progress.line(fmt::format("online: {}", setting.name));
    runs.names.emplace_back(setting.name);
    runs.experiments.push_back(online_experiment(setting, settings, sets, repeats));
    progress.advance(kOnline_s / static_cast<double>(where.size()), 0);
  }
  Result result{
      "online",
      "Physics-Informed Online Estimation of Stiffness and Shape of Soft Robotic Manipulators",
      {table_1(runs.experiments.front()), table_2(runs), improvements(runs), table_3(runs), payloads(runs),
       additions(runs)},
      {online_frames_series(where, runs.experiments), online_payload_series(where, runs.experiments)}};
  return result;
}

}  // namespace softarm::app::validate
