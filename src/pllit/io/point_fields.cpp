#include "pllit/io/point_fields.hpp"

#include <array>
#include <format>
#include <optional>
#include <utility>

namespace pllit {
namespace {

constexpr std::array<DatatypeFacts, 11> kDatatypes = {{{"", 0},
                                                       {"int8", 1},
                                                       {"uint8", 1},
                                                       {"int16", 2},
                                                       {"uint16", 2},
                                                       {"int32", 4},
                                                       {"uint32", 4},
                                                       {"float32", 4},
                                                       {"float64", 8},
                                                       {"int64", 8},
                                                       {"uint64", 8}}};
/// Fields whose datatype nobody defines are left out.
std::vector<PointField> read_fields(ByteReader& reader) {
  std::vector<PointField> fields;
  const auto count = reader.read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    PointField field{.name = std::string(reader.read_text()), .offset = reader.read<std::uint32_t>()};
    const auto type = reader.read<std::uint8_t>();
    const auto elements = reader.read<std::uint32_t>();
    field.type = static_cast<Datatype>(type);
    if (field.type == Datatype::uint32 && elements == 2) field.type = Datatype::uint64;  // how some drivers store ns
    if (type > 0 && type < kDatatypes.size()) fields.push_back(std::move(field));
  }
  return fields;
}

/// All sizes are compared without multiplying first, so that no claim of a damaged message can overflow.
std::optional<std::string> inconsistency(const PointFieldCloud& cloud) {
  if (cloud.width == 0 || cloud.height == 0) return std::nullopt;
  if (cloud.point_step == 0) return "point_step is 0";
  if (cloud.width > cloud.data.size() / cloud.point_step) {
    return std::format("a row of {} points of {} bytes does not fit into {} bytes of data", cloud.width,
                       cloud.point_step, cloud.data.size());
  }
  const std::size_t row = cloud.width * cloud.point_step;
  if (cloud.height > 1 && cloud.row_step < row) {
    return std::format("row_step {} is less than {} points of {} bytes", cloud.row_step, cloud.width, cloud.point_step);
  }
  if (cloud.height > 1 && cloud.height - 1 > (cloud.data.size() - row) / cloud.row_step) {
    return std::format("{} rows of {} bytes do not fit into {} bytes of data", cloud.height, cloud.row_step,
                       cloud.data.size());
  }
  return std::nullopt;
}

}  // namespace

const DatatypeFacts& facts_of(Datatype type) { return kDatatypes[static_cast<std::size_t>(type)]; }

Expected<PointFieldCloud> read_point_fields(Bytes message) {
  ByteReader reader(message);
  PointFieldCloud cloud;
  cloud.header = read_header(reader);
  cloud.height = reader.read<std::uint32_t>();
  cloud.width = reader.read<std::uint32_t>();
  cloud.fields = read_fields(reader);
  cloud.order = reader.read<std::uint8_t>() != 0 ? std::endian::big : std::endian::little;
  cloud.point_step = reader.read<std::uint32_t>();
  cloud.row_step = reader.read<std::uint32_t>();
  cloud.data = reader.read_block();
  reader.skip(1);  // is_dense: points are checked whatever it claims
  if (!reader.ok()) return input_error(std::format("PointCloud2 message of {} bytes is cut short", message.size()));
  if (const auto problem = inconsistency(cloud)) return input_error("PointCloud2 message: " + *problem);
  if (cloud.width == 0) cloud.height = 0;  // or a damaged message could claim billions of empty rows
  return cloud;
}

}  // namespace pllit
