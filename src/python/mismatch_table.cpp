#include "mismatch_table.h"

#include <pybind11/stl.h>

#include "arrays.h"

namespace softarm::python {
namespace {

using monitor::ChangeKind;
using monitor::MismatchAxis;

}  // namespace

void MismatchTable::add(const monitor::Mismatch& mismatch) {
  alarms_.add(mismatch);
  const auto said = [&](double value) { return mismatch.valid ? value : kAbsent; };
  valid_.push_back(mismatch.valid ? 1 : 0);
  laws_.push_back(mismatch.laws ? 1 : 0);
  score_.push_back(said(mismatch.score_sd));
  rms_.push_back(said(mismatch.rms_m));
  change_.push_back(said(mismatch.change_sd));
  threshold_.push_back(said(mismatch.threshold_sd));
  alarm_.push_back(mismatch.alarm ? 1 : 0);
  append(onset_, mismatch.onset_s);
  kind_.push_back(static_cast<std::int8_t>(mismatch.kind));
  or_kind_.push_back(static_cast<std::int8_t>(mismatch.or_kind.value_or(ChangeKind::kNone)));
  size_.push_back(said(mismatch.size_m));
  s_.push_back(said(mismatch.s_m));
  s_from_.push_back(said(mismatch.s_from_m));
  s_to_.push_back(said(mismatch.s_to_m));
  body_.push_back(static_cast<std::int16_t>(mismatch.body.value_or(-1)));
  axis_.push_back(static_cast<std::int8_t>(mismatch.axis));
  description_.push_back(mismatch.description);
}

pybind11::dict MismatchTable::take() {
  const auto n = static_cast<Py_ssize_t>(valid_.size());
  py::dict d;
  d["valid"] = array_of(std::move(valid_), {n});
  d["laws"] = array_of(std::move(laws_), {n});
  d["score_sd"] = array_of(std::move(score_), {n});
  d["rms_m"] = array_of(std::move(rms_), {n});
  d["change_sd"] = array_of(std::move(change_), {n});
  d["threshold_sd"] = array_of(std::move(threshold_), {n});
  d["alarm"] = array_of(std::move(alarm_), {n});
  d["onset_s"] = array_of(std::move(onset_), {n});
  d["kind_code"] = array_of(std::move(kind_), {n});
  d["or_kind_code"] = array_of(std::move(or_kind_), {n});
  d["size_m"] = array_of(std::move(size_), {n});
  d["s_m"] = array_of(std::move(s_), {n});
  d["s_from_m"] = array_of(std::move(s_from_), {n});
  d["s_to_m"] = array_of(std::move(s_to_), {n});
  d["body_index"] = array_of(std::move(body_), {n});
  d["axis_code"] = array_of(std::move(axis_), {n});
  d["description"] = std::move(description_);
  py::list alarms;
  for (const monitor::AlarmList::Alarm& alarm : alarms_.alarms())
    alarms.append(py::make_tuple(alarm.onset_s, alarm.seen_s, alarm.description));
  d["alarms"] = alarms;
  return d;
}

std::vector<std::string> change_kinds() {
  std::vector<std::string> words;
  for (int i = 0; i <= static_cast<int>(ChangeKind::kUnclear); ++i)
    words.push_back(monitor::to_string(static_cast<ChangeKind>(i)));
  return words;
}

std::vector<std::string> mismatch_axes() {
  std::vector<std::string> words;
  for (int i = 0; i <= static_cast<int>(MismatchAxis::kAxial); ++i)
    words.push_back(monitor::to_string(static_cast<MismatchAxis>(i)));
  return words;
}

}  // namespace softarm::python
