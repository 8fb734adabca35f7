#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

namespace stg::python {

/// Releases the GIL as long as this object lives.
///
/// While Python shuts down, it ends the threads that want the GIL back by unwinding their stacks
/// (pthread_exit). A destructor cannot be unwound, so pybind11's gil_scoped_release aborts the
/// program there. Callers higher on the stack would also drop references without the GIL. Instead,
/// such a thread waits here for the end of the process, as Python 3.14 does.
class WithoutGil {
 public:
  WithoutGil() : thread_(PyEval_SaveThread()) {}
  ~WithoutGil() {
    try {
      PyEval_RestoreThread(thread_);
    } catch (abi::__forced_unwind&) {
      for (;;) pause();
    }
  }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* thread_;
};

}  // namespace stg::python
