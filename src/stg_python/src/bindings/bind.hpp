#pragma once

#include <pybind11/pybind11.h>

namespace stg::python {

void BindScenario(pybind11::module_& module);
void BindVectorEnv(pybind11::module_& module);
void BindPolicy(pybind11::module_& module);
void BindAgent(pybind11::module_& module);

}  // namespace stg::python
