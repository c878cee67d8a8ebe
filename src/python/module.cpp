// softarm._softarm: what the Python package softarm is made of. Users see the package alone.
#include <glog/logging.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <string>

#include "parts.h"
#include "ros/open_bag.h"
#include "softarm/arm/arm_file.h"
#include "softarm/identify/identify.h"
#include "trial/csv_layout.h"

namespace softarm::python {
namespace {

namespace py = pybind11;

/// One line, whatever a library's message holds.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

PyObject *error_of_all = nullptr, *error_of_arms = nullptr, *error_of_bags = nullptr, *error_of_csv = nullptr,
         *error_of_fits = nullptr;

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const arm::ArmError& e) {
    PyErr_SetString(error_of_arms, one_line(e.what()).c_str());
  } catch (const BagError& e) {
    PyErr_SetString(error_of_bags, one_line(e.what()).c_str());
  } catch (const trial::CsvError& e) {
    PyErr_SetString(error_of_csv, one_line(e.what()).c_str());
  } catch (const identify::IdentifyError& e) {
    PyErr_SetString(error_of_fits, one_line(e.what()).c_str());
  } catch (const std::invalid_argument& e) {
    PyErr_SetString(PyExc_ValueError, one_line(e.what()).c_str());
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::runtime_error& e) {
    PyErr_SetString(error_of_all, one_line(e.what()).c_str());
  }
}

PyObject* new_error(py::module& module, const char* name, const char* meaning, PyObject* base) {
  const std::string full = std::string("softarm.") + name;
  PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), meaning, base, nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.attr(name) = py::handle(type);
  return type;
}

void add_errors(py::module& module) {
  error_of_all = new_error(module, "Error", "Anything that softarm cannot do. Its text is one line.",
                           PyExc_RuntimeError);
  error_of_arms = new_error(
      module, "ArmError", "An arm file that cannot be used: file, key, value, allowed range.", error_of_all);
  error_of_bags =
      new_error(module, "BagError", "A bag that cannot be used: file, what is wrong, remedy.", error_of_all);
  error_of_csv =
      new_error(module, "CsvError", "A layout or a CSV recording that cannot be used.", error_of_all);
  error_of_fits =
      new_error(module, "IdentifyError",
                "Trials that nothing can be fitted to: what is wrong, and the remedy.", error_of_all);
  py::register_exception_translator(&translate);
}

}  // namespace
}  // namespace softarm::python

PYBIND11_MODULE(_softarm, module) {
  namespace python = softarm::python;
  FLAGS_minloglevel = google::GLOG_FATAL;  // what became of a fit is said by who asked for it
  module.doc() = "What the package softarm is made of; use that.";
  module.attr("__version__") = SOFTARM_VERSION;
  module.attr("SOURCE_DIR") = SOFTARM_SOURCE_DIR;
  python::add_errors(module);
  python::add_arm(module);
  python::add_model(module);
  python::add_trial(module);
  python::add_estimate(module);
  python::add_identify(module);
  python::add_diagnose(module);
  python::add_check(module);
}
