// The parts of the module: each adds its functions.
#pragma once

#include <pybind11/pybind11.h>

namespace softarm::python {

void add_arm(pybind11::module& module);
void add_model(pybind11::module& module);
void add_trial(pybind11::module& module);
void add_estimate(pybind11::module& module);
void add_identify(pybind11::module& module);
void add_diagnose(pybind11::module& module);
void add_check(pybind11::module& module);

}  // namespace softarm::python
