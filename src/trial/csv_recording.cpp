#include "softarm/trial/csv_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

namespace softarm {
namespace {

constexpr std::size_t kMaxExamples = 5;

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') {
    const std::string trimmed = boost::trim_copy(line);
    boost::split(cells, trimmed, boost::is_any_of(" \t"), boost::token_compress_on);
  } else {
    boost::split(cells, line, [separator](char c) { return c == separator; });
  }
  for (std::string& cell : cells) boost::trim_if(cell, boost::is_any_of(" \t\r\""));
  return cells;
}

/// Thrown for a row that is skipped; the reason is also its key in CsvReport::bad_rows.
struct BadRow {
  std::string reason;
  std::string what;
};

/// @return the number, or nothing for an empty or non-finite cell
std::optional<double> number(const std::vector<std::string>& cells, std::size_t column) {
  if (column >= cells.size()) {
    throw BadRow{"too short", fmt::format("{} columns, column {} is needed", cells.size(), column + 1)};
  }
  const std::string& cell = cells[column];
  if (cell.empty()) return std::nullopt;
  double value = 0.0;
  const char* first = cell.data() + (cell.front() == '+' ? 1 : 0);
  const char* last = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(first, last, value);
  if (end != last || error == std::errc::invalid_argument) {
    throw BadRow{"not a number", fmt::format("column {} holds '{}'", column + 1, cell.substr(0, 30))};
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

class Reader {
 public:
  Reader(const CsvLayout& layout, const std::string& path, const std::function<void(const CsvRow&)>& on_row)
      : layout_(layout), path_(path), on_row_(on_row) {}

  CsvReport run() {
    std::ifstream file(path_);
    if (!file) throw CsvError(fmt::format("{}: cannot be read", path_));
    std::string line;
    for (int i = 0; i < layout_.skip_lines && std::getline(file, line); ++i) ++line_number_;
    std::vector<std::string> header;
    if (layout_.header && std::getline(file, line)) {
      ++line_number_;
      header = split(line, layout_.separator);
    }
    resolve(header);
    while (std::getline(file, line)) {
      ++line_number_;
      if (boost::trim_copy(line).empty() || line.front() == '#') continue;
      ++report_.rows;
      try {
        row(split(line, layout_.separator));
      } catch (const BadRow& bad) {
        ++report_.bad_rows[bad.reason];
        const std::string what = fmt::format("row skipped, {}: {}", bad.reason, bad.what);
        if (++bad_ == 1) first_bad_ = fmt::format("line {}: {}", line_number_, what);
        example(what);
      }
    }
    if (file.bad()) throw CsvError(fmt::format("{}: reading fails after line {}", path_, line_number_));
    if (report_.rows == 0) throw CsvError(fmt::format("{}: no rows of data", path_));
    if (2 * bad_ > report_.rows) {
      throw CsvError(
          fmt::format("{}: {} of {} rows cannot be used (first at {}); does the layout fit this file?", path_,
                      bad_, report_.rows, first_bad_));
    }
    return std::move(report_);
  }

 private:
  std::size_t resolve(const CsvColumn& column, const std::vector<std::string>& header) const {
    const auto found = std::find(header.begin(), header.end(), column.label);
    if (found != header.end()) return static_cast<std::size_t>(found - header.begin());
    std::size_t index = 0;
    const char* last = column.label.data() + column.label.size();
    const auto [end, error] = std::from_chars(column.label.data(), last, index);
    if (error != std::errc() || end != last || index < 1) {
      throw CsvError(fmt::format("{}: no column '{}' ({} of the layout); the header has {}", path_,
                                 column.label, column.key,
                                 header.empty() ? "nothing" : boost::join(header, ", ")));
    }
    return index - 1;
  }

  void resolve(const std::vector<std::string>& header) {
    time_ = resolve(layout_.time_column, header);
    for (const CsvBody& body : layout_.bodies) {
      std::vector<std::size_t> columns;
      for (const CsvColumn& c : body.position) columns.push_back(resolve(c, header));
      if (!body.fixed_orientation_xyzw) {
        for (const CsvColumn& c : body.orientation) columns.push_back(resolve(c, header));
      }
      body_columns_.push_back(std::move(columns));
    }
    for (const CsvPressure& p : layout_.pressures) pressure_columns_.push_back(resolve(p.column, header));
  }

  void row(const std::vector<std::string>& cells) {
    // A row that has text where a number belongs is refused as a whole, before any of it counts.
    for (const auto& columns : body_columns_) {
      for (const std::size_t c : columns) number(cells, c);
    }
    for (const std::size_t c : pressure_columns_) number(cells, c);
    const std::optional<double> time = number(cells, time_);
    if (!time) throw BadRow{"no time", fmt::format("column {}", time_ + 1)};
    CsvRow out;
    out.time_s = *time * layout_.time_scale_to_s;
    out.stamp_s = out.time_s + layout_.start_stamp_s;
    if (!(out.stamp_s > 0.0 && out.stamp_s < 4e9)) {
      throw BadRow{"time out of range",
                   fmt::format("{} s, must become a stamp from 0 to 4e9 s", out.stamp_s)};
    }
    if (!(out.time_s > last_time_s_)) {
      throw BadRow{"time goes back", fmt::format("{} s after {} s", out.time_s, last_time_s_)};
    }
    // A logger that is faster than the cameras writes the same poses again: that is no new measurement. One
    // body that stands still while others move is left in: whoever reads the bag judges whether it is frozen.
    std::vector<std::optional<double>> numbers;
    for (const auto& columns : body_columns_) {
      for (const std::size_t c : columns) numbers.push_back(number(cells, c));
    }
    if (layout_.drop_repeated && numbers == last_numbers_) {
      ++report_.repeated;
      out.bodies.resize(layout_.bodies.size());
    } else {
      std::size_t first = 0;
      for (std::size_t b = 0; b < layout_.bodies.size(); ++b) {
        out.bodies.push_back(pose(numbers, first, b));
        first += body_columns_[b].size();
      }
      last_numbers_ = std::move(numbers);
    }
    for (std::size_t i = 0; i < layout_.pressures.size(); ++i) {
      const std::optional<double> value = number(cells, pressure_columns_[i]);
      out.pressures_pa.push_back(std::nullopt);
      if (value) {
        const CsvPressure& p = layout_.pressures[i];
        out.pressures_pa.back() =
            (*value - p.zero) * p.scale_to_pa + (p.gauge ? layout_.ambient_pressure_pa : 0.0);
      } else {
        lost(layout_.pressures[i].topic, "not a number");
      }
    }
    last_time_s_ = out.time_s;
    ++report_.used;
    on_row_(out);
  }

  /// @param first index of the body's first number
  std::optional<CsvPose> pose(const std::vector<std::optional<double>>& numbers, std::size_t first,
                              std::size_t body) {
    std::array<double, 7> v{};
    if (const auto& fixed = layout_.bodies[body].fixed_orientation_xyzw)
      std::copy(fixed->begin(), fixed->end(), v.begin() + 3);
    for (std::size_t i = 0; i < body_columns_[body].size(); ++i) {
      const std::optional<double>& value = numbers[first + i];
      if (!value) return lost(layout_.bodies[body].name, "not a number");
      v[i] = *value;
    }
    CsvPose pose;
    pose.p_mocap = Eigen::Vector3d(v[0], v[1], v[2]) * layout_.position_scale_to_m;
    Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    // A unit quaternion is what a driver means; anything far from it is another column or a lost body.
    if (!(std::abs(q.norm() - 1.0) < 0.05)) {
      return lost(layout_.bodies[body].name,
                  q.norm() == 0.0 ? "zero quaternion" : "quaternion is not of unit length");
    }
    q.normalize();
    if (layout_.up == UpAxis::kY) {
      // y up to z up: a quarter turn about x carries y to z and z to -y.
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()));
      pose.p_mocap = Eigen::Vector3d(pose.p_mocap.x(), -pose.p_mocap.z(), pose.p_mocap.y());
      q = turn * q;
    }
    pose.q_mocap = q;
    return pose;
  }

  std::nullopt_t lost(const std::string& name, const std::string& reason) {
    if (++report_.lost[name + ": " + reason] == 1) example(fmt::format("{} absent: {}", name, reason));
    return std::nullopt;
  }

  void example(const std::string& what) {
    if (report_.examples.size() < kMaxExamples) {
      report_.examples.push_back(fmt::format("{}:{}: {}", path_, line_number_, what));
    }
  }

  const CsvLayout& layout_;
  const std::string& path_;
  const std::function<void(const CsvRow&)>& on_row_;
  std::size_t time_ = 0;
  std::vector<std::vector<std::size_t>> body_columns_;
  std::vector<std::size_t> pressure_columns_;
  std::vector<std::optional<double>> last_numbers_;
  double last_time_s_ = -std::numeric_limits<double>::infinity();
  std::uint64_t bad_ = 0;
  std::string first_bad_;
  std::uint64_t line_number_ = 0;
  CsvReport report_;
};

}  // namespace

CsvReport read_csv_recording(const CsvLayout& layout, const std::string& path,
                             const std::function<void(const CsvRow&)>& on_row) {
  return Reader(layout, path, on_row).run();
}

}  // namespace softarm
