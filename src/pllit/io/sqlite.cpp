#include "pllit/io/sqlite.hpp"

#include <format>
#include <system_error>

namespace pllit {
namespace {

constexpr int kPatience_ms = 3000;  // for another program that is just writing

Expected<void> check_file(const std::filesystem::path& path, SqliteDatabase::Access access) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status))
    return input_error(std::format("{}: is a folder; name a file", path.string()));
  if (access == SqliteDatabase::Access::read && !std::filesystem::exists(path, status))
    return input_error(std::format("{}: no such file", path.string()));
  const auto folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, status))
    return input_error(std::format("{}: its folder does not exist; make {} first", path.string(), folder.string()));
  return {};
}

}  // namespace

SqliteStatement& SqliteStatement::bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter + 1, value);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::string_view text) {
  sqlite3_bind_text(statement_.get(), parameter + 1, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::optional<double> value) {
  if (value)
    sqlite3_bind_double(statement_.get(), parameter + 1, *value);
  else
    sqlite3_bind_null(statement_.get(), parameter + 1);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::optional<bool> value) {
  if (value)
    sqlite3_bind_int(statement_.get(), parameter + 1, *value ? 1 : 0);
  else
    sqlite3_bind_null(statement_.get(), parameter + 1);
  return *this;
}

Expected<bool> SqliteStatement::next() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return std::unexpected(database_->error(code));
}

Expected<void> SqliteStatement::run() {
  for (;;) {
    const auto more = next();
    if (!more) return std::unexpected(more.error());
    if (!*more) return {};
  }
}

std::string SqliteStatement::text(int column) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))) : "";
}

std::optional<double> SqliteStatement::real(int column) const {
  return is_null(column) ? std::nullopt : std::optional(sqlite3_column_double(statement_.get(), column));
}

std::optional<bool> SqliteStatement::truth(int column) const {
  return is_null(column) ? std::nullopt : std::optional(sqlite3_column_int(statement_.get(), column) != 0);
}

Expected<SqliteDatabase> SqliteDatabase::open(const std::filesystem::path& path, Access access) {
  if (auto checked = check_file(path, access); !checked) return std::unexpected(checked.error());
  // Also to be read it is opened for writing where that is allowed: what a kill left half done must be taken back
  // first.
  const int flags = SQLITE_OPEN_READWRITE | (access == Access::write ? SQLITE_OPEN_CREATE : 0);
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_EXRESCODE, nullptr);
  SqliteDatabase database(path, handle);
  if (code != SQLITE_OK) return std::unexpected(database.error(code));
  sqlite3_busy_timeout(handle, kPatience_ms);
  // SQLite opens a file that it may only read for reading, and says so with the first write.
  if (access == Access::write && sqlite3_db_readonly(handle, "main") == 1)
    return std::unexpected(database.error(SQLITE_READONLY));
  // It looks at what the file holds with the first statement.
  if (const auto schema = database.number("PRAGMA schema_version"); !schema) return std::unexpected(schema.error());
  return database;
}

Expected<SqliteStatement> SqliteDatabase::prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  if (code != SQLITE_OK) return std::unexpected(error(code));
  return SqliteStatement(*this, statement);
}

Expected<void> SqliteDatabase::run(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return std::unexpected(error(code));
  return {};
}

Expected<std::int64_t> SqliteDatabase::number(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return std::unexpected(statement.error());
  const auto row = statement->next();
  if (!row) return std::unexpected(row.error());
  return *row ? statement->integer(0) : 0;
}

Error SqliteDatabase::error(int code) const {
  using Kind = Error::Kind;
  const auto say = [&](Kind kind, std::string_view what) {
    return Error{kind, std::format("{}: {}", path_.string(), what)};
  };
  const int system_error = sqlite3_system_errno(handle_.get());
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      return say(Kind::input, "is no SQLite file, so no store of visits; name another file");
    case SQLITE_CORRUPT:
      return say(Kind::input, "is damaged; restore it from a copy, or begin a new store");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return say(Kind::failure, "another program is writing to it; try again once that has ended");
    case SQLITE_READONLY:
      return say(Kind::input, "may only be read; name a file that may be written");
    case SQLITE_CANTOPEN:
      return say(Kind::input, "cannot be opened: " + std::generic_category().message(system_error));
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return say(Kind::failure, std::format("cannot be written or read: {}; it holds what it held before",
                                            system_error != 0 ? std::generic_category().message(system_error)
                                                              : std::string("the disk is full")));
    default:
      return say(Kind::failure, sqlite3_errmsg(handle_.get()));
  }
}

}  // namespace pllit
