// Serialising values into bytes, little-endian as ROS 1 does; the counterpart of ByteReader.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "pllit/io/byte_reader.hpp"

namespace pllit {

class ByteWriter {
 public:
  template <Number T>
  ByteWriter& write(T value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    if constexpr (std::endian::native != std::endian::little) std::ranges::reverse(raw);
    return write_bytes(raw);
  }
  ByteWriter& write_bytes(Bytes bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  /// Bytes or text behind their length in a uint32.
  ByteWriter& write_block(Bytes bytes) { return write(static_cast<std::uint32_t>(bytes.size())).write_bytes(bytes); }
  ByteWriter& write_text(std::string_view text) { return write_block(std::as_bytes(std::span(text))); }

  void reserve(std::size_t count) { bytes_.reserve(count); }
  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::byte>& bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace pllit
