// SQLite as far as a store needs it: every call checked, every error with the file's name and what to do. For the files
// beside it only.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pllit/base/error.hpp"

namespace pllit {

class SqliteDatabase;

/// One prepared statement. Parameters and columns count from zero.
class SqliteStatement {
 public:
  SqliteStatement& bind(int parameter, std::int64_t value);
  SqliteStatement& bind(int parameter, std::string_view text);
  SqliteStatement& bind(int parameter, std::optional<double> value);
  SqliteStatement& bind(int parameter, std::optional<bool> value);

  /// Goes to the next row; false after the last.
  Expected<bool> next();
  /// Runs it to its end.
  Expected<void> run();

  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  std::string text(int column) const;
  std::optional<double> real(int column) const;
  std::optional<bool> truth(int column) const;

 private:
  friend class SqliteDatabase;
  SqliteStatement(SqliteDatabase& database, sqlite3_stmt* statement)
      : database_(&database), statement_(statement, &sqlite3_finalize) {}
  bool is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

  SqliteDatabase* database_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_;
};

class SqliteDatabase {
 public:
  enum class Access { read, write };  ///< write: made where there is none

  /// Input errors: no such file (read), a folder, no SQLite file, one that may not be written.
  static Expected<SqliteDatabase> open(const std::filesystem::path& path, Access access);

  Expected<SqliteStatement> prepare(std::string_view sql);
  /// Runs statements that give no rows.
  Expected<void> run(const std::string& sql);
  /// The number that a statement without parameters gives.
  Expected<std::int64_t> number(std::string_view sql);
  std::int64_t last_row() const { return sqlite3_last_insert_rowid(handle_.get()); }
  /// The error of the last call, in words that name the file.
  Error error(int code) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  SqliteDatabase(std::filesystem::path path, sqlite3* handle)
      : path_(std::move(path)), handle_(handle, &sqlite3_close) {}

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> handle_;
};

}  // namespace pllit
