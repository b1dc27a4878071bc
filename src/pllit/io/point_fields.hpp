// The fields of a sensor_msgs/PointCloud2 message and the numbers in them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/byte_reader.hpp"
#include "pllit/io/ros_messages.hpp"

namespace pllit {

/// Numbers as in sensor_msgs/PointField; the two of 64 bits as PCL continues them.
enum class Datatype : std::uint8_t { int8 = 1, uint8, int16, uint16, int32, uint32, float32, float64, int64, uint64 };

struct DatatypeFacts {
  std::string_view name;
  std::size_t size_bytes;
};
const DatatypeFacts& facts_of(Datatype type);

struct PointField {
  std::string name;
  std::size_t offset = 0;
  Datatype type{};
};

/// A message whose data is known to hold height x width points, `row_step` and `point_step` bytes apart.
struct PointFieldCloud {
  RosHeader header;
  std::size_t height = 0;
  std::size_t width = 0;
  std::vector<PointField> fields;
  std::endian order = std::endian::little;
  std::size_t point_step = 0;
  std::size_t row_step = 0;
  Bytes data;

  Bytes point(std::size_t row, std::size_t column) const {
    return data.subspan(row * row_step + column * point_step, point_step);
  }
};

/// Errors: a message that is cut short or claims more than it holds.
Expected<PointFieldCloud> read_point_fields(Bytes message);

/// Calls use(number) with the field's number in its own type. The field lies within the point (checked beforehand).
template <class Use>
void with_number(Bytes point, const PointField& field, std::endian order, const Use& use) {
  const auto pass = [&]<Number T>(T /*type*/) {
    use(number_from<T>(point.subspan(field.offset).template first<sizeof(T)>(), order));
  };
  switch (field.type) {
    case Datatype::int8:
      return pass(std::int8_t{});
    case Datatype::uint8:
      return pass(std::uint8_t{});
    case Datatype::int16:
      return pass(std::int16_t{});
    case Datatype::uint16:
      return pass(std::uint16_t{});
    case Datatype::int32:
      return pass(std::int32_t{});
    case Datatype::uint32:
      return pass(std::uint32_t{});
    case Datatype::float32:
      return pass(float{});
    case Datatype::float64:
      return pass(double{});
    case Datatype::int64:
      return pass(std::int64_t{});
    case Datatype::uint64:
      return pass(std::uint64_t{});
  }
}

}  // namespace pllit
