#include "csv_units.h"

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <map>

namespace softarm::trial {
namespace {

/// By their lower case. Not those that differ from another by it: MPa, mN.
const std::map<std::string, std::string>& spellings() {
  static const std::map<std::string, std::string> all{{"s", "s"},
                                                      {"sec", "s"},
                                                      {"second", "s"},
                                                      {"seconds", "s"},
                                                      {"ms", "ms"},
                                                      {"msec", "ms"},
                                                      {"us", "us"},
                                                      {"usec", "us"},
                                                      {"\xC2\xB5s", "us"},
                                                      {"ns", "ns"},
                                                      {"nsec", "ns"},
                                                      {"m", "m"},
                                                      {"meter", "m"},
                                                      {"metre", "m"},
                                                      {"meters", "m"},
                                                      {"metres", "m"},
                                                      {"cm", "cm"},
                                                      {"mm", "mm"},
                                                      {"pa", "Pa"},
                                                      {"hpa", "hPa"},
                                                      {"kpa", "kPa"},
                                                      {"mbar", "mbar"},
                                                      {"bar", "bar"},
                                                      {"psi", "psi"},
                                                      {"rad", "rad"},
                                                      {"deg", "deg"},
                                                      {"degree", "deg"},
                                                      {"degrees", "deg"},
                                                      {"\xC2\xB0", "deg"},
                                                      {"n", "N"},
                                                      {"kgf", "kgf"},
                                                      {"gf", "gf"},
                                                      {"kg", "kg"},
                                                      {"g", "g"},
                                                      {"v", "V"},
                                                      {"mv", "mV"},
                                                      {"a", "A"},
                                                      {"ma", "mA"},
                                                      {"hz", "Hz"},
                                                      {"degc", "degC"},
                                                      {"\xC2\xB0"
                                                       "c",
                                                       "degC"},
                                                      {"m/s", "m/s"},
                                                      {"rad/s", "rad/s"},
                                                      {"m/s^2", "m/s^2"},
                                                      {"nm", "Nm"}};
  return all;
}

}  // namespace

std::string csv_unit(std::string text) {
  boost::trim_if(text, boost::is_any_of(" \t[](){}"));
  if (text == "MPa" || text == "mN") return text;
  const auto found = spellings().find(boost::to_lower_copy(text));
  return found == spellings().end() ? "" : found->second;
}

std::string unit_in_brackets(const std::string& name) {
  const std::size_t from = name.find_last_of("[(");
  if (from == std::string::npos || (name.back() != ']' && name.back() != ')')) return "";
  return csv_unit(name.substr(from));
}

bool is_units_row(const std::vector<std::string>& cells) {
  const auto is_unit = [](const std::string& cell) { return !csv_unit(cell).empty(); };
  const auto says_nothing = [](const std::string& cell) {
    return cell.empty() || cell == "-" || cell == "1";
  };
  const auto units = std::count_if(cells.begin(), cells.end(), is_unit);
  const auto said =
      static_cast<std::ptrdiff_t>(cells.size()) - std::count_if(cells.begin(), cells.end(), says_nothing);
  return units > 0 && 2 * units >= said;
}

}  // namespace softarm::trial
