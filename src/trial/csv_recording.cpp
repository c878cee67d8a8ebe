#include "csv_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <unordered_set>

#include "csv_clocks.h"
#include "csv_join.h"
#include "csv_table.h"

namespace softarm::trial {
namespace {

constexpr std::size_t kMaxExamples = 5;
constexpr std::uint64_t kBytesPerCall = 1 << 16;

/// A cell of the recording or of the inputs file that is joined to it.
struct Place {
  std::size_t index = 0;
  bool in_inputs = false;
};

class Reader {
 public:
  Reader(const CsvLayout& layout, const std::string& path, const std::function<void(const CsvRow&)>& on_row,
         const CsvSources& sources)
      : layout_(layout), table_(path, layout.format), on_row_(on_row), sources_(sources) {
    if (layout.join && sources.inputs_path.empty())
      throw CsvError(fmt::format("{}: its layout joins a file of inputs ({}), and none is given", path,
                                 layout.join->id.key));
    if (!layout.join && !sources.inputs_path.empty())
      throw CsvError(
          fmt::format("{}: is given, but the layout has no key 'join' that says how it belongs to {}",
                      sources.inputs_path, path));
    resolve();
  }

  CsvReport run() {
    std::uint64_t told = 0;
    while (table_.next()) {
      ++report_.rows;
      try {
        row();
      } catch (const CsvBadRow& bad) {
        ++report_.bad_rows[bad.reason];
        const std::string what = fmt::format("row skipped, {}: {}", bad.reason, bad.what);
        if (++bad_ == 1) first_bad_ = fmt::format("line {}: {}", table_.line(), what);
        example(what);
      }
      ++rows_of_trial_;
      if (sources_.on_bytes && table_.bytes() - told >= kBytesPerCall) {
        sources_.on_bytes(table_.bytes() - told);
        told = table_.bytes();
      }
    }
    if (sources_.on_bytes) sources_.on_bytes(table_.bytes() - told);
    hand_on_held();
    finish();
    return std::move(report_);
  }

 private:
  Place resolve(const CsvColumn& column) {
    if (!column.in_inputs) return {table_.resolve(column), false};
    inputs_columns_.push_back(column);
    return {inputs_columns_.size() - 1, true};
  }

  void resolve() {
    if (layout_.time_column) time_ = table_.resolve(*layout_.time_column);
    if (layout_.trial_column) trial_ = table_.resolve(*layout_.trial_column);
    if (layout_.join) id_ = table_.resolve(layout_.join->id);
    for (const CsvBody& body : layout_.bodies) {
      std::vector<std::size_t> columns;
      for (const CsvColumn& c : body.position) columns.push_back(table_.resolve(c));
      if (body.orientation) {
        for (const CsvColumn& c : *body.orientation) columns.push_back(table_.resolve(c));
      }
      body_columns_.push_back(std::move(columns));
    }
    for (const CsvPressure& p : layout_.pressures) pressures_.push_back(resolve(p.column));
    for (const CsvScalar& s : layout_.scalars) scalars_.push_back(resolve(s.column));
    if (layout_.payload_column) payload_ = resolve(layout_.payload_column->column);
    if (layout_.join) {
      join_ = std::make_unique<CsvJoin>(*layout_.join, sources_.inputs_path, inputs_columns_);
      report_.join = join_->report();
    }
  }

  void finish() {
    const std::string& path = table_.path();
    if (report_.rows == 0) throw CsvError(fmt::format("{}: no rows of data", path));
    if (2 * bad_ > report_.rows) {
      throw CsvError(
          fmt::format("{}: {} of {} rows cannot be used (first at {}); does the layout fit this file?", path,
                      bad_, report_.rows, first_bad_));
    }
    if (!join_) return;
    const std::uint64_t unmatched = report_.join->unmatched;
    if (2 * unmatched > report_.used) {
      throw CsvError(fmt::format("{}: lacks the ids of {} of {} rows of {} (first {}); are these its inputs?",
                                 join_->path(), unmatched, report_.used, path, first_unmatched_));
    }
    report_.join = join_->report();
    report_.join->unmatched = unmatched;
  }

  void row() {
    // A row that has text where a number belongs is refused as a whole, before any of it counts.
    for (const auto& columns : body_columns_) {
      for (const std::size_t c : columns) table_.number(c);
    }
    for (const auto* places : {&pressures_, &scalars_}) {
      for (const Place& p : *places) {
        if (!p.in_inputs) table_.number(p.index);
      }
    }
    if (payload_ && !payload_->in_inputs) table_.number(payload_->index);
    CsvRow out;
    if (trial_) enter_trial(table_.text(*trial_), out);
    stamp(out);
    const std::vector<std::optional<double>>* inputs = join_ ? joined() : nullptr;
    poses(out);
    for (std::size_t i = 0; i < pressures_.size(); ++i) {
      const CsvPressure& p = layout_.pressures[i];
      const std::optional<double> value = read(pressures_[i], inputs, p.topic);
      out.pressures_pa.push_back(std::nullopt);
      if (value)
        out.pressures_pa.back() =
            (*value - p.zero) * p.scale_to_pa + (p.gauge ? layout_.ambient_pressure_pa : 0.0);
    }
    for (std::size_t i = 0; i < scalars_.size(); ++i) {
      const CsvScalar& s = layout_.scalars[i];
      const std::optional<double> value = read(scalars_[i], inputs, s.topic);
      out.scalars.push_back(std::nullopt);
      if (value) out.scalars.back() = (*value - s.zero) * s.scale_to_si;
    }
    if (payload_) payload(read(*payload_, inputs, "/payload"), out);
    last_time_s_ = out.time_s;
    ++report_.used;
    if (layout_.bodies_ahead_s == 0.0) return on_row_(out);
    if (!held_.empty() && held_.back().trial != out.trial) hand_on_held();
    held_.push_back(std::move(out));
  }

  /// Rows of a trial whose clocks differ; there are none where they do not.
  void hand_on_held() {
    report_.one_clock_only += put_clocks_right(held_, layout_.bodies_ahead_s, on_row_);
    held_.clear();
  }

  void enter_trial(const std::string& cell, CsvRow& out) {
    if (cell.empty()) throw CsvBadRow{"no trial", fmt::format("column {} is empty", *trial_ + 1)};
    out.trial = csv_id(cell);
    if (out.trial == trial_name_) return;
    if (!trials_.insert(out.trial).second)
      throw CsvError(
          fmt::format("{}:{}: trial '{}' ({}) comes a second time; rows of a trial must be together",
                      table_.path(), table_.line(), out.trial, layout_.trial_column->key));
    trial_name_ = out.trial;
    rows_of_trial_ = 0;
    last_time_s_ = -std::numeric_limits<double>::infinity();
    last_numbers_.clear();
  }

  void stamp(CsvRow& out) const {
    const std::optional<double> time =
        time_ ? table_.number(*time_) : std::optional<double>(static_cast<double>(rows_of_trial_));
    if (!time) throw CsvBadRow{"no time", fmt::format("column {}", *time_ + 1)};
    out.time_s = *time * layout_.time_scale_to_s;
    const double stamp_s = out.time_s + layout_.start_stamp_s;
    if (!(stamp_s > 0.0 && stamp_s < 4e9)) {
      throw CsvBadRow{"time out of range", fmt::format("{} s, must become a stamp from 0 to 4e9 s", stamp_s)};
    }
    out.stamp = Stamp(layout_.start_stamp_s).later(out.time_s);
    if (!(out.time_s > last_time_s_)) {
      throw CsvBadRow{"time goes back", fmt::format("{} s after {} s", out.time_s, last_time_s_)};
    }
  }

  /// The inputs of this row; nullptr where they are not to be had.
  const std::vector<std::optional<double>>* joined() {
    const std::string& id = table_.text(id_);
    if (id.empty()) throw CsvBadRow{"no id", fmt::format("column {} is empty", id_ + 1)};
    if (!ids_.insert(csv_id(id)).second)
      throw CsvBadRow{"id given twice", fmt::format("'{}' was there before", id)};
    const auto* inputs = join_->find(id);
    if (!inputs && ++report_.join->unmatched == 1) {
      first_unmatched_ = fmt::format("'{}' in line {}", id, table_.line());
      example(fmt::format("no inputs for id '{}' in {}", id, join_->path()));
    }
    return inputs;
  }

  void poses(CsvRow& out) {
    // A logger that is faster than the cameras writes the same poses again: that is no new measurement. One
    // body that stands still while others move is left in: whoever reads the bag judges whether it is frozen.
    std::vector<std::optional<double>> numbers;
    for (const auto& columns : body_columns_) {
      for (const std::size_t c : columns) numbers.push_back(table_.number(c));
    }
    if (layout_.drop_repeated && numbers == last_numbers_) {
      ++report_.repeated;
      out.bodies.resize(layout_.bodies.size());
      return;
    }
    std::size_t first = 0;
    for (std::size_t b = 0; b < layout_.bodies.size(); ++b) {
      out.bodies.push_back(pose(numbers, first, b));
      first += body_columns_[b].size();
    }
    last_numbers_ = std::move(numbers);
  }

  /// @param first index of the body's first number
  std::optional<CsvPose> pose(const std::vector<std::optional<double>>& numbers, std::size_t first,
                              std::size_t index) {
    const CsvBody& body = layout_.bodies[index];
    std::array<double, 7> v{};
    if (const auto& fixed = body.fixed_orientation_xyzw)
      std::copy(fixed->begin(), fixed->end(), v.begin() + 3);
    for (std::size_t i = 0; i < body_columns_[index].size(); ++i) {
      const std::optional<double>& value = numbers[first + i];
      if (!value) return lost(body.name, "not a number");
      v[i] = *value;
    }
    // y up to z up: a quarter turn about x carries y to z and z to -y.
    const bool y_up = layout_.up == UpAxis::kY;
    CsvPose pose;
    pose.p_mocap = Eigen::Vector3d(v[0], v[1], v[2]) * layout_.position_scale_to_m;
    if (y_up) pose.p_mocap = Eigen::Vector3d(pose.p_mocap.x(), -pose.p_mocap.z(), pose.p_mocap.y());
    if (!body.orientation && !body.fixed_orientation_xyzw) return pose;
    Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    // A unit quaternion is what a driver means; anything far from it is another column or a lost body.
    if (!(std::abs(q.norm() - 1.0) < 0.05)) {
      return lost(body.name, q.norm() == 0.0 ? "zero quaternion" : "quaternion is not of unit length");
    }
    q.normalize();
    if (y_up) q = Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX())) * q;
    pose.q_mocap = q;
    return pose;
  }

  std::optional<double> read(const Place& place, const std::vector<std::optional<double>>* inputs,
                             const std::string& name) {
    if (place.in_inputs && !inputs) return std::nullopt;  // counted once a row, as unmatched
    const std::optional<double> value = place.in_inputs ? (*inputs)[place.index] : table_.number(place.index);
    if (!value) return lost(name, "not a number");
    return value;
  }

  void payload(const std::optional<double>& value, CsvRow& out) {
    if (!value) return;
    const double kg = *value * layout_.payload_column->scale_to_kg;
    if (kg >= 0.0 && kg <= 100.0) {
      out.payload_kg = kg;
    } else {
      lost("/payload", "not from 0 to 100 kg");
    }
  }

  std::nullopt_t lost(const std::string& name, const std::string& reason) {
    if (++report_.lost[name + ": " + reason] == 1) example(fmt::format("{} absent: {}", name, reason));
    return std::nullopt;
  }

  void example(const std::string& what) {
    if (report_.examples.size() < kMaxExamples) {
      report_.examples.push_back(fmt::format("{}:{}: {}", table_.path(), table_.line(), what));
    }
  }

  const CsvLayout& layout_;
  CsvTable table_;
  const std::function<void(const CsvRow&)>& on_row_;
  const CsvSources& sources_;
  std::optional<std::size_t> time_, trial_;
  std::size_t id_ = 0;
  std::vector<std::vector<std::size_t>> body_columns_;
  std::vector<Place> pressures_, scalars_;
  std::optional<Place> payload_;
  std::vector<CsvColumn> inputs_columns_;
  std::unique_ptr<CsvJoin> join_;
  std::unordered_set<std::string> ids_;
  std::set<std::string> trials_;
  std::string trial_name_, first_unmatched_;
  std::uint64_t rows_of_trial_ = 0;
  std::vector<std::optional<double>> last_numbers_;
  double last_time_s_ = -std::numeric_limits<double>::infinity();
  std::vector<CsvRow> held_;  // of one trial, until its end
  std::uint64_t bad_ = 0;
  std::string first_bad_;
  CsvReport report_;
};

}  // namespace

CsvReport read_csv_recording(const CsvLayout& layout, const std::string& path,
                             const std::function<void(const CsvRow&)>& on_row, const CsvSources& sources) {
  return Reader(layout, path, on_row, sources).run();
}

}  // namespace softarm::trial
