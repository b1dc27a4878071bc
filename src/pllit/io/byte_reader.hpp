// Bounds-checked reading of serialised values; the only way in which bytes of a recording become numbers.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

namespace pllit {

template <class T>
concept Number = std::integral<T> || std::floating_point<T>;

using Bytes = std::span<const std::byte>;

/// One number at the front of exactly sizeof(T) bytes.
template <Number T>
T number_from(std::span<const std::byte, sizeof(T)> bytes, std::endian order = std::endian::little) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data(), sizeof(T));
  if (order != std::endian::native) {
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
  }
  return std::bit_cast<T>(raw);
}

/// A cursor over bytes. Reading past the end yields zeros and makes ok() false for good, so that a whole message can be
/// read first and judged once.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes, std::endian order = std::endian::little) : bytes_(bytes), order_(order) {}

  bool ok() const { return ok_; }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

  template <Number T>
  T read() {
    const Bytes raw = read_bytes(sizeof(T));
    return raw.empty() ? T{} : number_from<T>(raw.first<sizeof(T)>(), order_);
  }

  /// The next `count` bytes, or none of them where fewer are left.
  Bytes read_bytes(std::size_t count) {
    if (count > remaining()) {
      ok_ = false;
      position_ = bytes_.size();
      return {};
    }
    const Bytes result = bytes_.subspan(position_, count);
    position_ += count;
    return result;
  }

  void skip(std::size_t count) { read_bytes(count); }

  /// Bytes or text with a uint32 length in front, as ROS serialises strings and arrays of bytes.
  Bytes read_block() { return read_bytes(read<std::uint32_t>()); }
  std::string_view read_text() {
    const Bytes text = read_block();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

 private:
  Bytes bytes_;
  std::endian order_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace pllit
