// Random access to bytes in a file or in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/byte_reader.hpp"

namespace pllit {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// `count` bytes from `offset`, valid until the next call; empty where they reach beyond the end or cannot be read.
  virtual Bytes at(std::uint64_t offset, std::size_t count) = 0;
};

class MemoryBytes final : public ByteSource {
 public:
  explicit MemoryBytes(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  Bytes at(std::uint64_t offset, std::size_t count) override {
    if (offset > bytes_.size() || count > bytes_.size() - offset) return {};
    return Bytes(bytes_).subspan(offset, count);
  }

 private:
  std::vector<std::byte> bytes_;
};

/// A file, read through one window that is refilled where a request leaves it: neighbouring small records cost one
/// read, and what nobody asks for is never read.
class FileBytes final : public ByteSource {
 public:
  static Expected<std::unique_ptr<FileBytes>> open(const std::filesystem::path& path);
  ~FileBytes() override;
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::uint64_t size() const override { return size_; }
  Bytes at(std::uint64_t offset, std::size_t count) override;

 private:
  FileBytes(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  int descriptor_;
  std::uint64_t size_;
  std::uint64_t window_offset_ = 0;
  std::size_t window_count_ = 0;
  std::vector<std::byte> window_;
};

}  // namespace pllit
