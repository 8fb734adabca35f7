#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

/// Checks that numpy arrays have the required shape and type.
namespace stg::python {

namespace py = pybind11;

using Shape = std::vector<py::ssize_t>;

/// "(256, 4, 3)"
inline std::string Text(const py::ssize_t* extents, py::ssize_t count) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < count; ++k) text += (k == 0 ? "" : ", ") + std::to_string(extents[k]);
  return text + (count == 1 ? ",)" : ")");
}
inline std::string Text(const Shape& shape) {
  return Text(shape.data(), static_cast<py::ssize_t>(shape.size()));
}

inline std::string Text(const py::dtype& type) {
  return py::str(static_cast<const py::handle&>(type)).cast<std::string>();
}

/// Throws TypeError unless `object` is a numpy array, and ValueError unless it has this shape.
inline py::array RequireArray(const py::handle& object, const std::string& name,
                              const Shape& shape) {
  if (!py::isinstance<py::array>(object)) {
    throw py::type_error(name + ": expected a numpy array of shape " + Text(shape) + ", not " +
                         std::string(Py_TYPE(object.ptr())->tp_name));
  }
  py::array array = py::reinterpret_borrow<py::array>(object);
  if (Shape(array.shape(), array.shape() + array.ndim()) != shape) {
    throw py::value_error(name + ": expected shape " + Text(shape) + ", not " +
                          Text(array.shape(), array.ndim()));
  }
  return array;
}

/// An array of the caller for output. Its type must be exactly `Number`. It must be row-major,
/// without gaps and writable.
template <class Number>
Number* RequireOutput(const py::handle& object, const std::string& name, const Shape& shape) {
  py::array array = RequireArray(object, name, shape);
  if (!array.dtype().equal(py::dtype::of<Number>())) {
    throw py::type_error(name + ": expected dtype " + Text(py::dtype::of<Number>()) + ", not " +
                         Text(array.dtype()));
  }
  if ((array.flags() & py::array::c_style) == 0) {
    throw py::value_error(name + ": expected a C-contiguous array");
  }
  if (!array.writeable()) throw py::value_error(name + ": the array is read-only");
  return static_cast<Number*>(array.mutable_data());
}

/// Float32 or float64 numbers of any strides, made contiguous if necessary. `wide`: they are
/// float64.
struct Floats {
  py::array array;
  bool wide;
};
inline Floats RequireFloats(const py::handle& object, const std::string& name, const Shape& shape) {
  py::array array = RequireArray(object, name, shape);
  const py::dtype type = array.dtype();
  const bool wide = type.equal(py::dtype::of<double>());
  if (!wide && !type.equal(py::dtype::of<float>())) {
    throw py::type_error(name + ": expected dtype float32 or float64, not " + Text(type));
  }
  if ((array.flags() & py::array::c_style) == 0) {
    array = py::array::ensure(array, py::array::c_style);
    if (!array) throw py::error_already_set();
  }
  return {array, wide};
}

/// Index of the first number that is not finite, or -1. For speed, it first checks all numbers at
/// once.
template <class Number, class Bits>
std::ptrdiff_t FindNotFinite(const Number* numbers, std::ptrdiff_t count, Bits exponent) {
  static_assert(sizeof(Number) == sizeof(Bits), "bits of the number");
  Bits bad = 0;
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    Bits bits;
    std::memcpy(&bits, numbers + k, sizeof bits);
    bad |= static_cast<Bits>((bits & exponent) == exponent);
  }
  if (bad == 0) return -1;
  for (std::ptrdiff_t k = 0;; ++k) {
    Bits bits;
    std::memcpy(&bits, numbers + k, sizeof bits);
    if ((bits & exponent) == exponent) return k;
  }
}
inline std::ptrdiff_t FindNotFinite(const float* numbers, std::ptrdiff_t count) {
  return FindNotFinite(numbers, count, std::uint32_t{0x7f800000});
}
inline std::ptrdiff_t FindNotFinite(const double* numbers, std::ptrdiff_t count) {
  return FindNotFinite(numbers, count, std::uint64_t{0x7ff0000000000000});
}

}  // namespace stg::python
