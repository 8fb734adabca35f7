#pragma once

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Evaluates any ONNX graph by the definitions of its operators, in double precision. It shares no
/// code with the networks that write the files.
namespace stg::agent {

struct OnnxTensor {
  std::vector<int> shape;
  std::vector<double> x;

  int size() const {
    int n = 1;
    for (const int d : shape) n *= d;
    return n;
  }
  /// The size of all axes before an axis (outer) and of all axes after it (inner).
  int outer(int axis) const {
    int n = 1;
    for (int k = 0; k < axis; ++k) n *= shape[static_cast<std::size_t>(k)];
    return n;
  }
  int inner(int axis) const {
    int n = 1;
    for (std::size_t k = static_cast<std::size_t>(axis) + 1; k < shape.size(); ++k) n *= shape[k];
    return n;
  }
  double& at(int k) { return x[static_cast<std::size_t>(k)]; }
  double at(int k) const { return x[static_cast<std::size_t>(k)]; }
};

class OnnxInterpreter {
 public:
  using Values = std::map<std::string, OnnxTensor>;

  /// Runs a model. Returns all values by name.
  static Values Run(const onnx::ModelProto& model, Values values) {
    for (const onnx::TensorProto& t : model.graph().initializer()) {
      OnnxTensor m;
      for (const auto d : t.dims()) m.shape.push_back(static_cast<int>(d));
      std::vector<float> data(t.raw_data().size() / sizeof(float));
      std::memcpy(data.data(), t.raw_data().data(), t.raw_data().size());
      m.x.assign(data.begin(), data.end());
      EXPECT_EQ(m.size(), static_cast<int>(m.x.size())) << t.name();
      values[t.name()] = m;
    }
    for (const onnx::NodeProto& node : model.graph().node()) {
      std::vector<OnnxTensor> in;
      for (const std::string& name : node.input()) in.push_back(values.at(name));
      values[node.output(0)] = Apply(node, in);
    }
    return values;
  }

 private:
  static int Attribute(const onnx::NodeProto& node, const std::string& name) {
    for (const auto& a : node.attribute()) {
      if (a.name() == name) return static_cast<int>(a.ints_size() > 0 ? a.ints(0) : a.i());
    }
    ADD_FAILURE() << node.op_type() << " without " << name;
    return 0;
  }

  static OnnxTensor Apply(const onnx::NodeProto& node, const std::vector<OnnxTensor>& in) {
    const std::string& op = node.op_type();
    if (op == "MatMul") return MatMul(in[0], in[1]);
    if (op == "Add") return Broadcast(in[0], in[1], std::plus<>());
    if (op == "Mul") return Broadcast(in[0], in[1], std::multiplies<>());
    if (op == "Relu") return Each(in[0], [](double v) { return std::max(v, 0.0); });
    if (op == "Tanh") return Each(in[0], [](double v) { return std::tanh(v); });
    if (op == "Log") return Each(in[0], [](double v) { return std::log(v); });
    if (op == "Concat") return Concat(in, Attribute(node, "axis"));
    if (op == "Softmax") return Softmax(in[0], Attribute(node, "axis"));
    if (op == "Transpose") return Transpose(in[0]);
    if (op == "Unsqueeze") {
      OnnxTensor y = in[0];
      y.shape.insert(y.shape.begin() + Attribute(node, "axes"), 1);
      return y;
    }
    if (op.rfind("Reduce", 0) == 0) {
      return Reduce(in[0], op, Attribute(node, "axes"), Attribute(node, "keepdims") != 0);
    }
    ADD_FAILURE() << "unknown operator " << op;
    return {};
  }

  template <class F>
  static OnnxTensor Each(OnnxTensor y, const F& f) {
    for (double& v : y.x) v = f(v);
    return y;
  }

  /// Product of [..., k] and [k, n].
  static OnnxTensor MatMul(const OnnxTensor& a, const OnnxTensor& b) {
    EXPECT_EQ(b.shape.size(), 2u);
    EXPECT_EQ(a.shape.back(), b.shape[0]);
    const int inner = b.shape[0], columns = b.shape[1];
    const int rows = a.outer(static_cast<int>(a.shape.size()) - 1);
    OnnxTensor y{a.shape, std::vector<double>(static_cast<std::size_t>(rows * columns))};
    y.shape.back() = columns;
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        for (int k = 0; k < inner; ++k) {
          y.at(r * columns + c) += a.at(r * inner + k) * b.at(k * columns + c);
        }
      }
    }
    return y;
  }

  template <class F>
  static OnnxTensor Broadcast(const OnnxTensor& a, const OnnxTensor& b, const F& f) {
    const std::size_t axes = std::max(a.shape.size(), b.shape.size());
    const auto whole = [axes](const OnnxTensor& t) {
      std::vector<int> shape(axes - t.shape.size(), 1);
      shape.insert(shape.end(), t.shape.begin(), t.shape.end());
      return shape;
    };
    const std::vector<int> p = whole(a), q = whole(b);
    OnnxTensor y;
    for (std::size_t k = 0; k < axes; ++k) {
      EXPECT_TRUE(p[k] == q[k] || p[k] == 1 || q[k] == 1);
      y.shape.push_back(p[k] == 1 ? q[k] : p[k]);
    }
    y.x.resize(static_cast<std::size_t>(y.size()));
    for (int n = 0; n < y.size(); ++n) {
      int rest = n, i = 0, j = 0, step_a = 1, step_b = 1;
      for (std::size_t k = axes; k-- > 0;) {
        const int place = rest % y.shape[k];
        rest /= y.shape[k];
        i += (p[k] == 1 ? 0 : place) * step_a;
        j += (q[k] == 1 ? 0 : place) * step_b;
        step_a *= p[k];
        step_b *= q[k];
      }
      y.at(n) = f(a.at(i), b.at(j));
    }
    return y;
  }

  static OnnxTensor Concat(const std::vector<OnnxTensor>& in, int axis) {
    OnnxTensor y = in[0];
    const auto k = static_cast<std::size_t>(axis);
    y.shape[k] = 0;
    for (const OnnxTensor& t : in) y.shape[k] += t.shape[k];
    y.x.clear();
    for (int o = 0; o < y.outer(axis); ++o) {
      for (const OnnxTensor& t : in) {
        const int block = t.shape[k] * t.inner(axis);
        y.x.insert(y.x.end(), t.x.begin() + o * block, t.x.begin() + (o + 1) * block);
      }
    }
    EXPECT_EQ(y.size(), static_cast<int>(y.x.size()));
    return y;
  }

  /// Softmax of a matrix along its rows.
  static OnnxTensor Softmax(const OnnxTensor& a, int axis) {
    EXPECT_EQ(a.shape.size(), 2u);
    EXPECT_EQ(axis, 1);
    OnnxTensor y = a;
    for (int r = 0; r < a.shape[0]; ++r) {
      double sum = 0.0;
      for (int c = 0; c < a.shape[1]; ++c) sum += std::exp(a.at(r * a.shape[1] + c));
      for (int c = 0; c < a.shape[1]; ++c) {
        y.at(r * a.shape[1] + c) = std::exp(a.at(r * a.shape[1] + c)) / sum;
      }
    }
    return y;
  }

  static OnnxTensor Transpose(const OnnxTensor& a) {
    EXPECT_EQ(a.shape.size(), 2u);
    OnnxTensor y{{a.shape[1], a.shape[0]}, a.x};
    for (int r = 0; r < a.shape[0]; ++r) {
      for (int c = 0; c < a.shape[1]; ++c) y.at(c * a.shape[0] + r) = a.at(r * a.shape[1] + c);
    }
    return y;
  }

  static OnnxTensor Reduce(const OnnxTensor& a, const std::string& op, int axis, bool keep) {
    const int count = a.shape[static_cast<std::size_t>(axis)], inner = a.inner(axis);
    OnnxTensor y;
    for (int o = 0; o < a.outer(axis); ++o) {
      for (int i = 0; i < inner; ++i) {
        double sum = 0.0, most = -1e300;
        for (int k = 0; k < count; ++k) {
          const double v = a.at((o * count + k) * inner + i);
          sum += v;
          most = std::max(most, v);
        }
        y.x.push_back(op == "ReduceMax" ? most : op == "ReduceMean" ? sum / count : sum);
      }
    }
    y.shape = a.shape;
    if (keep) {
      y.shape[static_cast<std::size_t>(axis)] = 1;
    } else {
      y.shape.erase(y.shape.begin() + axis);
    }
    return y;
  }
};

}  // namespace stg::agent
