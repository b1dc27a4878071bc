// Files whose every write is checked: a full disk becomes an error that names the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "pllit/base/error.hpp"

namespace pllit {

/// A file being written. Nothing is held back: after each call the bytes are the kernel's, so a killed process loses
/// none of them.
class OutputFile {
 public:
  /// Creates the file, or empties an existing one.
  static Expected<OutputFile> create(const std::filesystem::path& path);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// Appends at the end.
  Expected<void> write(std::string_view bytes);
  /// Overwrites bytes that are already there.
  Expected<void> write_at(std::uint64_t offset, std::string_view bytes);
  /// Cuts the file back to `size` bytes, after a write that did not fit.
  void cut_to(std::uint64_t size);
  /// Brings the bytes to the disk itself, so that they survive a power cut.
  Expected<void> sync();
  /// Closes and reports what the file system found only then (network disks).
  Expected<void> close();

  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  OutputFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Writes a whole file at once, into the path itself.
Expected<void> write_file(const std::filesystem::path& path, std::string_view bytes);

/// Writes to part_path() and renames, so that a reader sees the old file or the new one and never half of one.
Expected<void> replace_file(const std::filesystem::path& path, std::string_view bytes);

/// Where a file is written until it is complete: the path with .part behind it.
std::filesystem::path part_path(const std::filesystem::path& path);

/// Renames the complete part_path(path) to path, in one step for every reader.
Expected<void> put_in_place(const std::filesystem::path& path);

/// A file to be read; an input error names one that is absent, a folder or unreadable.
Expected<std::ifstream> open_file(const std::filesystem::path& path);

/// The whole content of a file; an input error names a file that is absent or unreadable.
Expected<std::string> read_file(const std::filesystem::path& path);

}  // namespace pllit
