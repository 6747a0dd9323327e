#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace mba_vo::test {

/// Writes the few parts of ONNX (a protocol buffer) that networks for tests need.
class Message {
 public:
  Message& number(int field, std::uint64_t value) {
    varint(static_cast<std::uint64_t>(field) << 3U);
    varint(value);
    return *this;
  }
  Message& real(int field, float value) {
    varint((static_cast<std::uint64_t>(field) << 3U) | 5U);
    char raw[sizeof(float)];
    std::memcpy(raw, &value, sizeof(float));
    bytes_.append(raw, sizeof(float));
    return *this;
  }
  Message& text(int field, const std::string& bytes) {
    varint((static_cast<std::uint64_t>(field) << 3U) | 2U);
    varint(bytes.size());
    bytes_ += bytes;
    return *this;
  }
  Message& message(int field, const Message& m) { return text(field, m.bytes_); }
  const std::string& bytes() const { return bytes_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 128U; value >>= 7U) bytes_ += static_cast<char>((value & 127U) | 128U);
    bytes_ += static_cast<char>(value);
  }
  std::string bytes_;
};

/// Input or output of a graph: name, floats, 1 x channels x height x width; 0 = any.
inline Message onnxValue(const std::string& name, std::uint64_t channels, std::uint64_t height = 0,
                         std::uint64_t width = 0) {
  Message shape;
  shape.message(1, Message().number(1, 1)).message(1, Message().number(1, channels));
  shape.message(1, height > 0 ? Message().number(1, height) : Message().text(2, "h"));
  shape.message(1, width > 0 ? Message().number(1, width) : Message().text(2, "w"));
  return Message().text(1, name).message(2, Message().message(1, Message().number(1, 1).message(2, shape)));
}

inline Message onnxIntegers(const std::string& name, const std::vector<std::uint64_t>& values) {
  Message attribute;
  attribute.text(1, name).number(20, 7);
  for (const std::uint64_t value : values) attribute.number(8, value);
  return attribute;
}

/// A network of one operator on "in", with `weights` of the given shape as second input if there are any.
inline std::string onnxNetwork(const std::string& op, std::uint64_t channels, std::uint64_t channels_out,
                               const std::vector<float>& weights, const std::vector<std::uint64_t>& shape,
                               const std::vector<Message>& attributes) {
  Message node;
  node.text(1, "in");
  if (!weights.empty()) node.text(1, "weights");
  node.text(2, "out").text(3, "node").text(4, op);
  for (const Message& a : attributes) node.message(5, a);
  Message graph;
  graph.message(1, node).text(2, "graph");
  if (!weights.empty()) {
    Message tensor;
    for (const std::uint64_t n : shape) tensor.number(1, n);
    std::string raw(weights.size() * sizeof(float), '\0');
    std::memcpy(raw.data(), weights.data(), raw.size());
    graph.message(5, tensor.number(2, 1).text(8, "weights").text(9, raw));
  }
  graph.message(11, onnxValue("in", channels)).message(12, onnxValue("out", channels_out));
  const Message opset = Message().text(1, "").number(2, 10);
  return Message().number(1, 5).text(2, "test").message(7, graph).message(8, opset).bytes();
}

/// A convolution with one kernel of 3x3 per channel, the channels apart or, with one output channel, summed.
inline std::string onnxConvolution(std::uint64_t channels, std::uint64_t channels_out,
                                   const std::vector<float>& kernel) {
  std::vector<float> weights;
  for (std::uint64_t o = 0; o < channels_out; ++o) {
    for (std::uint64_t i = 0; i < channels; ++i) {
      for (const float k : kernel) weights.push_back(o == i ? k : 0.0F);
    }
  }
  return onnxNetwork("Conv", channels, channels_out, weights, {channels_out, channels, 3, 3},
                     {onnxIntegers("kernel_shape", {3, 3}), onnxIntegers("pads", {1, 1, 1, 1})});
}

}  // namespace mba_vo::test
