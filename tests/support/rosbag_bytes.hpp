// Raw messages through rosbag, for comparing our reader with it.
#pragma once

#include <rosbag/bag.h>

#include <cstdint>
#include <string>
#include <vector>

namespace pllit::test {

/// Serialised bytes of any type.
struct RawMessage {
  std::string type;
  std::string md5 = "*";
  std::string definition;
  std::vector<std::uint8_t> bytes;
};

inline std::vector<std::uint8_t> bytes_of(const rosbag::MessageInstance& message) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  return bytes;
}

}  // namespace pllit::test

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<pllit::test::RawMessage> {
  static const char* value(const pllit::test::RawMessage& message) { return message.md5.c_str(); }
};
template <>
struct DataType<pllit::test::RawMessage> {
  static const char* value(const pllit::test::RawMessage& message) { return message.type.c_str(); }
};
template <>
struct Definition<pllit::test::RawMessage> {
  static const char* value(const pllit::test::RawMessage& message) { return message.definition.c_str(); }
};
}  // namespace message_traits

namespace serialization {
template <>
struct Serializer<pllit::test::RawMessage> {
  template <class Stream>
  static void write(Stream& stream, const pllit::test::RawMessage& message) {
    std::copy(message.bytes.begin(), message.bytes.end(), stream.advance(serializedLength(message)));
  }
  static std::uint32_t serializedLength(const pllit::test::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros
