#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

namespace stg::python {

/// Gives the GIL up for as long as it lives.
///
/// Python ends the threads that ask for the GIL back while it shuts down, by unwinding their stacks
/// (pthread_exit). A destructor cannot be unwound, so that pybind11's gil_scoped_release aborts the
/// program there, and what lies above would drop references without the GIL. Such a thread waits
/// here for the end of the process instead, as Python 3.14 lets it do.
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
