// A valid ONNX model of one node that hands its input on, spelt out byte by byte (onnx.proto, protobuf's wire format).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pllit::test {

namespace onnx_bytes {
inline std::string number(int field, int value) {  // values below 128
  return {static_cast<char>(field << 3), static_cast<char>(value)};
}
inline std::string block(int field, std::string_view content) {
  std::string bytes(1, static_cast<char>(field << 3 | 2));
  std::size_t size = content.size();
  for (; size >= 128; size /= 128) bytes += static_cast<char>(size % 128 + 128);
  return bytes + static_cast<char>(size) + std::string(content);
}
inline std::string float_tensor(std::string_view name, const std::vector<int>& shape) {
  std::string dimensions;
  for (const int size : shape) dimensions += block(1, number(1, size));
  return block(1, name) + block(2, block(1, number(1, 1) + block(2, dimensions)));
}
}  // namespace onnx_bytes

inline std::string tiny_model(std::string_view input, std::string_view output, const std::vector<int>& shape) {
  using namespace onnx_bytes;
  const std::string node = block(1, input) + block(2, output) + block(4, "Identity");
  const std::string graph =
      block(1, node) + block(2, "g") + block(11, float_tensor(input, shape)) + block(12, float_tensor(output, shape));
  return number(1, 8) + block(7, graph) + block(8, number(2, 17));
}

}  // namespace pllit::test
