#include <pybind11/pybind11.h>

#include "../../../../cmake/x86_64_v3.h"

PYBIND11_MODULE(_processor, module) {
  module.doc() = "What this processor offers; compiled for every one.";
  module.attr("X86_64_V3") = stg_has_x86_64_v3() != 0;
}
