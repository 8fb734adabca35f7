#include "onnx_operators.hpp"

namespace stg::agent {

void OnnxOperators::Value(onnx::ValueInfoProto* info, const std::string& name,
                          const std::vector<int>& dimensions) {
  info->set_name(name);
  auto* type = info->mutable_type()->mutable_tensor_type();
  type->set_elem_type(onnx::TensorProto::FLOAT);
  const char* free[] = {"rows_of_", "columns_of_"};
  int unnamed = 0;
  for (const int size : dimensions) {
    auto* dimension = type->mutable_shape()->add_dim();
    if (size > 0) {
      dimension->set_dim_value(size);
    } else {
      dimension->set_dim_param(free[unnamed++] + name);
    }
  }
}

void OnnxOperators::Input(const std::string& name, const std::vector<int>& dimensions) {
  Value(graph_->add_input(), name, dimensions);
}

void OnnxOperators::Output(const std::string& name, const std::vector<int>& dimensions) {
  Value(graph_->add_output(), name, dimensions);
}

std::string OnnxOperators::Node(const std::string& op, const std::vector<std::string>& inputs,
                                const std::string& output, const Attributes& attributes) {
  onnx::NodeProto* node = graph_->add_node();
  node->set_op_type(op);
  node->set_name(output);
  for (const std::string& input : inputs) node->add_input(input);
  node->add_output(output);
  for (const auto& [name, value] : attributes) {
    onnx::AttributeProto* a = node->add_attribute();
    a->set_name(name);
    if (name == "axes") {
      a->set_type(onnx::AttributeProto::INTS);
      a->add_ints(value);
    } else {
      a->set_type(onnx::AttributeProto::INT);
      a->set_i(value);
    }
  }
  return output;
}

void OnnxOperators::Tensor(const std::string& name, int rows, int cols,
                           const std::vector<float>& data) {
  onnx::TensorProto* tensor = graph_->add_initializer();
  tensor->set_name(name);
  tensor->set_data_type(onnx::TensorProto::FLOAT);
  tensor->add_dims(rows);
  tensor->add_dims(cols);
  tensor->set_raw_data(data.data(), data.size() * sizeof(float));
}

std::string OnnxOperators::Constant(const std::string& name, const PoolBlock& block) {
  std::vector<float> data(block.size());
  const float* from = numbers_.data() + block.offset;
  for (int r = 0; r < block.rows; ++r) {
    for (int c = 0; c < block.cols; ++c) {
      data[static_cast<std::size_t>(c * block.rows + r)] = *from++;
    }
  }
  Tensor(name, block.cols, block.rows, data);
  held_.push_back({block, true});
  return name;
}

std::string OnnxOperators::Upright(const std::string& name, const PoolBlock& block) {
  const float* from = numbers_.data() + block.offset;
  Tensor(name, block.rows, block.cols, {from, from + block.size()});
  held_.push_back({block, false});
  return name;
}

std::string OnnxOperators::Fixed(const std::string& name, int rows, int cols,
                                 const std::vector<float>& data) {
  Tensor(name, rows, cols, data);
  held_.push_back({});
  return name;
}

std::string OnnxOperators::Dense(const std::string& input, const std::string& name,
                                 const PoolBlocks::Layer& layer, bool relu) {
  Node("MatMul", {input, Constant(name + "_weight", layer.weight)}, name + "_product");
  Node("Add", {name + "_product", Constant(name + "_bias", layer.bias)}, name + "_sum");
  return relu ? Node("Relu", {name + "_sum"}, name + "_out") : name + "_sum";
}

std::string OnnxOperators::Embed(const std::string& name, const PoolBlocks::Set& set) {
  return Dense(Dense(name, name + "_1", set.first, true), name + "_2", set.second, true);
}

}  // namespace stg::agent
