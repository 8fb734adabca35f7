#include "auv_common/error.hpp"
#include "bind.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ engine of the package stg; use it through the package stg only.";
  module.attr("__version__") = STG_VERSION;
  module.attr("INSTRUCTION_SET") = STG_INSTRUCTION_SET;
  py::register_exception<stg::UserError>(module, "UserError", PyExc_ValueError).doc() =
      "Bad input: the message names file, line and key where they are known.";
  stg::python::BindScenario(module);
  stg::python::BindVectorEnv(module);
  stg::python::BindPolicy(module);
  stg::python::BindAgent(module);
}
