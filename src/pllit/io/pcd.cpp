#include "pllit/io/pcd.hpp"

#include <format>

#include "pllit/io/file.hpp"
#include "pllit/io/point_records.hpp"

namespace pllit {
namespace {

/// `key` followed by one word for each column.
std::string repeated(std::string_view key, std::string_view word, std::size_t columns) {
  std::string line(key);
  for (std::size_t i = 0; i < columns; ++i) line += std::format(" {}", word);
  return line + "\n";
}

std::string header_of(const PointTable& table) {
  const std::size_t columns = 3 + table.fields.size();
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z";
  for (const ScalarField& field : table.fields) header += " " + field.name;
  header += "\n" + repeated("SIZE", "4", columns) + repeated("TYPE", "F", columns) + repeated("COUNT", "1", columns);
  header += std::format("WIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n", table.points.size());
  return header;
}

}  // namespace

Expected<void> write_pcd(const std::filesystem::path& path, const PointTable& table) {
  const auto checked = check_field_names(field_names(table)).and_then([&] { return check_points(table); });
  if (!checked) return in_context(path.string(), checked.error());
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  return file->write(header_of(table))
      .and_then([&] { return for_float_rows(table, [&](const std::string& rows) { return file->write(rows); }); })
      .and_then([&] { return file->close(); });
}

}  // namespace pllit
