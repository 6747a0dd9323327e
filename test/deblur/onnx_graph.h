#pragma once

#include <array>
#include <cmath>

#include <opencv2/core.hpp>

#include "deblur/onnx_writer.h"

namespace mba_vo::test {

inline Message onnxReal(const std::string& name, float value) {
  return Message().text(1, name).real(2, value).number(20, 1);
}
inline Message onnxInteger(const std::string& name, std::uint64_t value) {
  return Message().text(1, name).number(3, value).number(20, 2);
}
inline Message onnxText(const std::string& name, const std::string& value) {
  return Message().text(1, name).text(4, value).number(20, 3);
}

/// Networks of many operators with random weights, on "in" of 1 x `channels`; each step gives the name of its result.
class OnnxGraph {
 public:
  using Name = std::string;

  explicit OnnxGraph(std::uint64_t channels) : channels_(channels) {}

  Name op(const std::string& type, const std::vector<Name>& inputs, const std::vector<Message>& attributes = {}) {
    const Name output = "v" + std::to_string(count_++);
    Message node;
    for (const Name& input : inputs) node.text(1, input);
    node.text(2, output).text(3, "n_" + output).text(4, type);
    for (const Message& attribute : attributes) node.message(5, attribute);
    graph_.message(1, node);
    return output;
  }
  Name relu(const Name& x) { return op("Relu", {x}); }
  Name add(const Name& a, const Name& b) { return op("Add", {a, b}); }
  Name multiply(const Name& a, const Name& b) { return op("Mul", {a, b}); }
  Name concat(const std::vector<Name>& parts) { return op("Concat", parts, {onnxInteger("axis", 1)}); }

  /// Of a square kernel. `gain`: of the weights, 1 keeps the spread of what goes in.
  Name conv(const Name& x, std::uint64_t in, std::uint64_t out, std::uint64_t side, std::uint64_t stride = 1,
            std::uint64_t groups = 1, float gain = 1.0F) {
    const std::uint64_t pad = (side - 1) / 2;
    return op("Conv", {x, random({out, in / groups, side, side}, gain), zeros(out)},
              {onnxIntegers("kernel_shape", {side, side}), onnxIntegers("strides", {stride, stride}),
               onnxIntegers("pads", {pad, pad, pad, pad}), onnxInteger("group", groups)});
  }
  /// Twice the size.
  Name transposedConv(const Name& x, std::uint64_t in, std::uint64_t out) {
    return op(
        "ConvTranspose", {x, random({in, out, 4, 4}, 2.0F), zeros(out)},
        {onnxIntegers("kernel_shape", {4, 4}), onnxIntegers("strides", {2, 2}), onnxIntegers("pads", {1, 1, 1, 1})});
  }
  Name instanceNorm(const Name& x, std::uint64_t channels) {
    return op("InstanceNormalization", {x, constant({channels}, std::vector<float>(channels, 1.0F)), zeros(channels)},
              {onnxReal("epsilon", 1e-5F)});
  }
  Name resize(const Name& x, float factor, const std::string& mode) {
    return op("Resize", {x, constant({4}, {1.0F, 1.0F, factor, factor})}, {onnxText("mode", mode)});
  }
  Name half(const Name& x) {
    return op("AveragePool", {x}, {onnxIntegers("kernel_shape", {2, 2}), onnxIntegers("strides", {2, 2})});
  }
  /// What exports for one size are full of: no other size goes through.
  Name fix(const Name& x, std::uint64_t height, std::uint64_t width) {
    height_ = height;
    width_ = width;
    const std::array<std::int64_t, 4> shape{1, static_cast<std::int64_t>(channels_), static_cast<std::int64_t>(height),
                                            static_cast<std::int64_t>(width)};
    std::string raw(sizeof(shape), '\0');
    std::memcpy(raw.data(), shape.data(), raw.size());
    return op("Reshape", {x, tensor({4}, 7, raw)});
  }
  Name constant(const std::vector<std::uint64_t>& shape, const std::vector<float>& values) {
    std::string raw(values.size() * sizeof(float), '\0');
    std::memcpy(raw.data(), values.data(), raw.size());
    return tensor(shape, 1, raw);
  }

  /// The file of the network whose result is `last`.
  std::string file(const Name& last) {
    Message graph = graph_;
    graph.message(1, Message().text(1, last).text(2, "out").text(3, "last").text(4, "Identity")).text(2, "graph");
    graph.message(11, onnxValue("in", channels_, height_, width_))
        .message(12, onnxValue("out", channels_, height_, width_));
    const Message opset = Message().text(1, "").number(2, 10);
    return Message().number(1, 5).text(2, "test").message(7, graph).message(8, opset).bytes();
  }

 private:
  Name zeros(std::uint64_t count) { return constant({count}, std::vector<float>(count, 0.0F)); }
  Name random(const std::vector<std::uint64_t>& shape, float gain) {
    std::vector<float> values(shape[0] * shape[1] * shape[2] * shape[3]);
    const double spread = gain * std::sqrt(2.0 / static_cast<double>(shape[1] * shape[2] * shape[3]));
    for (float& value : values) value = static_cast<float>(random_.gaussian(spread));
    return constant(shape, values);
  }
  Name tensor(const std::vector<std::uint64_t>& shape, std::uint64_t type, const std::string& raw) {
    const Name name = "w" + std::to_string(count_++);
    Message tensor;
    for (const std::uint64_t n : shape) tensor.number(1, n);
    graph_.message(5, tensor.number(2, type).text(8, name).text(9, raw));
    return name;
  }

  std::uint64_t channels_;
  std::uint64_t height_ = 0, width_ = 0;  // 0 = any
  Message graph_;
  int count_ = 0;
  cv::RNG random_{7};
};

/// In the shape of SRN-DeblurNet: from coarse to fine, the same encoder and decoder at each of three scales, fed with
/// the blurred image and the result of the scale before, and a state that goes from scale to scale through a gate.
inline std::string srnNetwork(std::uint64_t fixed_height = 0, std::uint64_t fixed_width = 0) {
  constexpr std::uint64_t kColours = 3;
  constexpr std::uint64_t kFeatures = 8;
  OnnxGraph g(kColours);
  const std::string in = fixed_height > 0 ? g.fix("in", fixed_height, fixed_width) : "in";
  const std::vector<std::string> scales{g.half(g.half(in)), g.half(in), in};
  std::string before;
  std::string state;
  for (const std::string& blurred : scales) {
    const std::string guess = before.empty() ? blurred : g.resize(before, 2.0F, "nearest");
    const std::string wide = g.relu(g.conv(g.concat({blurred, guess}), 2 * kColours, kFeatures, 5));
    std::string deep = g.relu(g.conv(wide, kFeatures, 2 * kFeatures, 3, 2));
    if (!state.empty()) {
      const std::string both = g.concat({deep, g.resize(state, 2.0F, "nearest")});
      const std::string gate = g.op("Sigmoid", {g.conv(both, 4 * kFeatures, 2 * kFeatures, 3)});
      deep = g.multiply(gate, g.op("Tanh", {g.conv(both, 4 * kFeatures, 2 * kFeatures, 3)}));
    }
    state = deep;
    const std::string again = g.add(wide, g.relu(g.transposedConv(deep, 2 * kFeatures, kFeatures)));
    before = g.add(blurred, g.conv(again, kFeatures, kColours, 5, 1, 1, 0.1F));
  }
  return g.file(before);
}

/// In the shape of DeblurGANv2 with MobileNet: an encoder of depth-wise convolutions down to a sixteenth, a pyramid of
/// features from there up again, all its levels brought to one size and put together, and the input added.
inline std::string pyramidNetwork(std::uint64_t fixed_height = 0, std::uint64_t fixed_width = 0) {
  constexpr std::uint64_t kColours = 3;
  constexpr std::uint64_t kFeatures = 8;
  OnnxGraph g(kColours);
  const std::string in = fixed_height > 0 ? g.fix("in", fixed_height, fixed_width) : "in";
  const auto relu6 = [&](const std::string& x) {
    return g.op("Clip", {x}, {onnxReal("min", 0.0F), onnxReal("max", 6.0F)});
  };
  std::vector<std::string> levels{relu6(g.conv(in, kColours, kFeatures, 3, 2))};
  for (int level = 0; level < 3; ++level) {  // inverted residuals
    const std::string wide = relu6(g.instanceNorm(g.conv(levels.back(), kFeatures, 2 * kFeatures, 1), 2 * kFeatures));
    const std::string depthwise = relu6(g.conv(wide, 2 * kFeatures, 2 * kFeatures, 3, 2, 2 * kFeatures));
    levels.push_back(g.conv(depthwise, 2 * kFeatures, kFeatures, 1));
  }
  std::vector<std::string> pyramid{levels.back()};
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    pyramid.push_back(g.add(g.conv(levels[i], kFeatures, kFeatures, 1), g.resize(pyramid.back(), 2.0F, "nearest")));
  }
  std::vector<std::string> heads;
  float factor = 8.0F;
  for (const std::string& level : pyramid) {
    const std::string head = g.relu(g.conv(level, kFeatures, kFeatures, 3));
    heads.push_back(factor > 1.0F ? g.resize(head, factor, "nearest") : head);
    factor /= 2.0F;
  }
  const std::string smooth = g.relu(g.instanceNorm(g.conv(g.concat(heads), 4 * kFeatures, kFeatures, 3), kFeatures));
  const std::string large = g.resize(smooth, 2.0F, "nearest");
  const std::string change = g.op("Tanh", {g.conv(large, kFeatures, kColours, 3, 1, 1, 0.1F)});
  return g.file(g.op("Clip", {g.add(change, in)}, {onnxReal("min", -1.0F), onnxReal("max", 1.0F)}));
}

}  // namespace mba_vo::test
