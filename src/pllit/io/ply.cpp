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

Expected<void> add_property(PlyHeader& header, std::istringstream& words) {
  std::string type, name;
  words >> type >> name;
  const auto known = std::ranges::find_if(kTypes, [&](const auto& t) { return t.name == type || t.alias == type; });
  if (known == kTypes.end()) return input_error(std::format("vertex property '{} {}' is not a number", type, name));
  header.properties.push_back({name, header.row_bytes, known->value});
  header.row_bytes += known->bytes;
  return {};
}

/// Reads one header line into `header`; `element` is the element that properties belong to at this point.
Expected<void> read_header_line(const std::string& line, PlyHeader& header, std::string& element) {
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

Expected<PlyHeader> read_header(std::ifstream& stream) {
  constexpr std::size_t kLongest = 1 << 16;  // bytes; what goes on without end is none
  PlyHeader header;
  std::string line, element;
  for (bool first = true; header.data_begin < kLongest && std::getline(stream, line); first = false) {
    header.data_begin += line.size() + 1;
    if (line.ends_with('\r')) line.pop_back();
    if (first && line != "ply") return input_error("is not a PLY file");
    if (line == "end_header") return header;
    if (auto read = read_header_line(line, header, element); !read) return std::unexpected(read.error());
  }
  return input_error(header.data_begin == 0 ? "is not a PLY file" : "its header does not end");
}

/// Checks that the bytes hold what the header promises, before anything is allocated for it.
Expected<void> check_size(const PlyHeader& header, std::uintmax_t file_bytes) {
  for (const std::string_view axis : {"x", "y", "z"})
    if (std::ranges::count(header.properties, axis, &PlyHeader::Property::name) != 1)
      return input_error(std::format("its vertices need one property {}", axis));
  const std::uintmax_t held = (file_bytes - header.data_begin) / header.row_bytes;
  if (held < header.points)
    return input_error(std::format("promises {} points and holds {}: the file was cut", header.points, held));
  return {};
}

PointTable table_from(const PlyHeader& header, const char* rows, std::size_t count) {
  PointTable table;
  table.points.resize(count);
  for (const PlyHeader::Property& property : header.properties) {
    const auto axis = std::string_view("xyz").find(property.name);
    const bool is_axis = property.name.size() == 1 && axis != std::string_view::npos;
    if (!is_axis) table.fields.push_back({property.name, std::vector<float>(count)});
    for (std::size_t i = 0; i < count; ++i) {
      const float value = property.value(rows + i * header.row_bytes + property.offset);
      if (is_axis)
        table.points[i][static_cast<Eigen::Index>(axis)] = value;
      else
        table.fields.back().values[i] = value;
    }
  }
  return table;
}

/// Adds every n-th point of a part that begins with the cloud's point `first`.
void add_every(PointTable& table, const PointTable& part, std::size_t first, std::size_t every) {
  if (table.fields.empty())
    for (const ScalarField& field : part.fields) table.fields.push_back({field.name, {}});
  for (std::size_t i = (every - first % every) % every; i < part.points.size(); i += every) {
    table.points.push_back(part.points[i]);
    for (std::size_t f = 0; f < table.fields.size(); ++f) table.fields[f].values.push_back(part.fields[f].values[i]);
  }
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

Expected<PlyReader> PlyReader::open(const std::filesystem::path& path) {
  auto stream = open_file(path);
  if (!stream) return std::unexpected(stream.error());
  auto header = read_header(*stream);
  if (!header) return in_context(path.string(), header.error());
  std::error_code status;
  const std::uintmax_t bytes = std::filesystem::file_size(path, status);
  if (status) return input_error(std::format("{}: {}", path.string(), status.message()));
  if (auto checked = check_size(*header, bytes); !checked) return in_context(path.string(), checked.error());
  return PlyReader(path, std::move(*stream), std::move(*header));
}

Expected<PointTable> PlyReader::next(std::size_t most) {
  const std::size_t count = std::min(most, header_.points - read_);
  std::string rows(count * header_.row_bytes, '\0');
  if (!stream_.read(rows.data(), static_cast<std::streamsize>(rows.size())))
    return input_error(std::format("{}: cannot be read beyond point {}", path_.string(), read_));
  read_ += count;
  return table_from(header_, rows.data(), count);
}

Expected<PointTable> read_ply(const std::filesystem::path& path, std::size_t most) {
  constexpr std::size_t kPart = 1 << 16;
  auto reader = PlyReader::open(path);
  if (!reader) return std::unexpected(reader.error());
  if (reader->size() <= most) return reader->next(most);
  const std::size_t every = (reader->size() - 1) / std::max<std::size_t>(1, most) + 1;
  PointTable table;
  for (std::size_t read = 0; read < reader->size(); read += kPart) {
    const auto part = reader->next(kPart);
    if (!part) return part;
    add_every(table, *part, read, every);
  }
  return table;
}

}  // namespace pllit
