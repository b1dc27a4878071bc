#include "pllit/io/csv.hpp"

#include <cmath>
#include <format>
#include <string_view>
#include <utility>

namespace pllit {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

struct CellText {
  std::string operator()(double value) const { return std::isfinite(value) ? std::format("{}", value) : ""; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
};

/// Where the cell that starts at `begin` ends: at a comma, a line's end, or nowhere (npos) where the text was cut.
std::size_t end_of_cell(std::string_view text, std::size_t begin) {
  bool inside_quotes = false;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (text[i] == '"') inside_quotes = !inside_quotes;
    if (!inside_quotes && (text[i] == ',' || text[i] == '\n')) return i;
  }
  return text.npos;
}

std::string unquoted(std::string_view cell) {
  if (cell.ends_with('\r')) cell.remove_suffix(1);
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return std::string(cell);
  cell = cell.substr(1, cell.size() - 2);
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;
  }
  return text;
}

std::vector<std::vector<std::string>> finished_rows(std::string_view text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  for (std::size_t begin = 0, end = 0; (end = end_of_cell(text, begin)) != text.npos; begin = end + 1) {
    row.push_back(unquoted(text.substr(begin, end - begin)));
    if (text[end] == '\n') rows.push_back(std::exchange(row, {}));
  }
  return rows;
}

}  // namespace

Expected<CsvWriter> CsvWriter::create(const std::filesystem::path& path, std::span<const std::string> columns) {
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  CsvWriter writer(std::move(*file), columns.size());
  if (auto header = writer.append(std::vector<CsvCell>(columns.begin(), columns.end())); !header)
    return std::unexpected(header.error());
  return writer;
}

Expected<void> CsvWriter::append(std::span<const CsvCell> row) {
  if (row.size() != columns_)
    return failure(
        std::format("{}: a row of {} cells, the table has {} columns", file_.path().string(), row.size(), columns_));
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i == 0 ? "" : ",") + std::visit(CellText{}, row[i]);
  const std::uint64_t before = file_.size();
  auto written = file_.write(line + "\n");
  if (!written) file_.cut_to(before);
  return written;
}

Expected<CsvTable> read_csv(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  auto rows = finished_rows(*text);
  if (rows.empty()) return input_error(std::format("{}: holds no header row", path.string()));
  CsvTable table{rows.front(), {rows.begin() + 1, rows.end()}};
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].size() != table.columns.size())
      return input_error(std::format("{} row {}: {} cells, the header names {}", path.string(), i + 1,
                                     table.rows[i].size(), table.columns.size()));
  return table;
}

}  // namespace pllit
