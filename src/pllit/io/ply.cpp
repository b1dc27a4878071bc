#include "pllit/io/ply.hpp"

#include <array>
#include <charconv>
#include <cstring>
#include <format>
#include <optional>
#include <sstream>

#include "pllit/io/point_records.hpp"

namespace pllit {
namespace {

constexpr std::string_view kBeforeCount =
    "ply\nformat binary_little_endian 1.0\ncomment PL-LIT, metres\nelement vertex ";

std::string count_text(std::size_t points) { return std::format("{:010}", points); }

/// One number property of a vertex: where its bytes lie in a row, and how they become a float.
struct Property {
  std::string name;
  std::size_t offset;
  float (*value)(const char* bytes);
};

struct Header {
  std::size_t points = 0;
  std::size_t row_bytes = 0;
  std::size_t data_begin = 0;
  std::vector<Property> properties;
};

template <class Number>
float float_from(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<float>(value);
}

struct NumberType {
  std::string_view name, alias;
  std::size_t bytes;
  float (*value)(const char* bytes);
};
constexpr std::array<NumberType, 8> kTypes{{{"float", "float32", 4, float_from<float>},
                                            {"double", "float64", 8, float_from<double>},
                                            {"uchar", "uint8", 1, float_from<std::uint8_t>},
                                            {"char", "int8", 1, float_from<std::int8_t>},
                                            {"ushort", "uint16", 2, float_from<std::uint16_t>},
                                            {"short", "int16", 2, float_from<std::int16_t>},
                                            {"uint", "uint32", 4, float_from<std::uint32_t>},
                                            {"int", "int32", 4, float_from<std::int32_t>}}};

Expected<void> add_property(Header& header, std::istringstream& words) {
  std::string type, name;
  words >> type >> name;
  const auto known = std::ranges::find_if(kTypes, [&](const auto& t) { return t.name == type || t.alias == type; });
  if (known == kTypes.end()) return input_error(std::format("vertex property '{} {}' is not a number", type, name));
  header.properties.push_back({name, header.row_bytes, known->value});
  header.row_bytes += known->bytes;
  return {};
}

/// Reads one header line into `header`; `element` is the element that properties belong to at this point.
Expected<void> read_header_line(const std::string& line, Header& header, std::string& element) {
  std::istringstream words(line);
  std::string key;
  words >> key;
  if (key == "format") {
    std::string format;
    words >> format;
    if (format != "binary_little_endian")
      return input_error(std::format("format '{}', expected binary_little_endian", format));
  } else if (key == "element") {
    const bool first = element.empty();
    words >> element;
    if (element == "vertex" && !first) return input_error("the vertices do not come first");
    if (element == "vertex" && !(words >> header.points)) return input_error("the number of vertices is not a number");
  } else if (key == "property" && element == "vertex") {
    return add_property(header, words);
  }
  return {};
}

Expected<Header> read_header(const std::string& bytes) {
  if (!bytes.starts_with("ply\n") && !bytes.starts_with("ply\r\n")) return input_error("is not a PLY file");
  Header header;
  std::string element;
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\n', begin)) != bytes.npos; begin = end + 1) {
    std::string line = bytes.substr(begin, end - begin);
    if (line.ends_with('\r')) line.pop_back();
    if (line == "end_header") {
      header.data_begin = end + 1;
      return header;
    }
    if (auto read = read_header_line(line, header, element); !read) return std::unexpected(read.error());
  }
  return input_error("its header does not end");
}

/// Checks that the bytes hold what the header promises, before anything is allocated for it.
Expected<void> check_size(const Header& header, std::size_t file_bytes) {
  for (const std::string_view axis : {"x", "y", "z"})
    if (std::ranges::count(header.properties, axis, &Property::name) != 1)
      return input_error(std::format("its vertices need one property {}", axis));
  const std::size_t held = (file_bytes - header.data_begin) / header.row_bytes;
  if (held < header.points)
    return input_error(std::format("promises {} points and holds {}: the file was cut", header.points, held));
  return {};
}

PointTable table_from(const Header& header, const char* rows) {
  PointTable table;
  table.points.resize(header.points);
  for (const Property& property : header.properties) {
    const auto axis = std::string_view("xyz").find(property.name);
    const bool is_axis = property.name.size() == 1 && axis != std::string_view::npos;
    if (!is_axis) table.fields.push_back({property.name, std::vector<float>(header.points)});
    for (std::size_t i = 0; i < header.points; ++i) {
      const float value = property.value(rows + i * header.row_bytes + property.offset);
      if (is_axis)
        table.points[i][static_cast<Eigen::Index>(axis)] = value;
      else
        table.fields.back().values[i] = value;
    }
  }
  return table;
}

}  // namespace

Expected<PlyStream> PlyStream::create(const std::filesystem::path& path, std::vector<std::string> fields) {
  if (auto checked = check_field_names(fields); !checked) return in_context(path.string(), checked.error());
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  std::string header(kBeforeCount);
  header += count_text(0) + "\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string& field : fields) header += std::format("property float {}\n", field);
  header += "end_header\n";
  if (auto written = file->write(header); !written) return std::unexpected(written.error());
  return PlyStream(std::move(*file), std::move(fields), kBeforeCount.size());
}

Expected<void> PlyStream::append(const PointTable& table) {
  if (field_names(table) != fields_)
    return failure(std::format("{}: the points' scalar fields are not those of the file", file_.path().string()));
  if (auto checked = check_points(table); !checked) return in_context(file_.path().string(), checked.error());
  const std::uint64_t before = file_.size();
  const auto total = points_ + table.points.size();
  auto written = for_float_rows(table, [&](const std::string& rows) { return file_.write(rows); }).and_then([&] {
    return file_.write_at(count_offset_, count_text(total));
  });
  if (!written) {
    file_.cut_to(before);
    return written;
  }
  points_ = total;
  return {};
}

Expected<void> write_ply(const std::filesystem::path& path, const PointTable& table) {
  auto stream = PlyStream::create(path, field_names(table));
  if (!stream) return std::unexpected(stream.error());
  if (auto written = stream->append(table); !written) return written;
  return stream->close();
}

Expected<PointTable> read_ply(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  const auto header = read_header(*bytes);
  if (!header) return in_context(path.string(), header.error());
  if (auto checked = check_size(*header, bytes->size()); !checked) return in_context(path.string(), checked.error());
  return table_from(*header, bytes->data() + header->data_begin);
}

}  // namespace pllit
