// Tables of named columns as CSV (RFC 4180), a row at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/file.hpp"

namespace pllit {

/// A number or text; a double that is not finite becomes an empty cell.
using CsvCell = std::variant<double, std::int64_t, std::string>;

/// Rows of text, each as long as `columns`.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// Writes a table row by row; each row is in the file when append() returns.
class CsvWriter {
 public:
  static Expected<CsvWriter> create(const std::filesystem::path& path, std::span<const std::string> columns);

  /// Fails on a full disk and on a row of another length; the file stays readable.
  Expected<void> append(std::span<const CsvCell> row);
  Expected<void> close() { return file_.close(); }

 private:
  CsvWriter(OutputFile file, std::size_t columns) : file_(std::move(file)), columns_(columns) {}

  OutputFile file_;
  std::size_t columns_;
};

/// Reads what a CsvWriter left, even where it was killed: a last line without its end is ignored. Input errors name
/// file and row.
Expected<CsvTable> read_csv(const std::filesystem::path& path);

}  // namespace pllit
