#include "pllit/io/byte_source.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <format>

namespace pllit {
namespace {

constexpr std::size_t kWindowBytes = 16 * 1024;

/// Reads until `into` is full or nothing more comes; returns how many bytes came.
std::size_t read_at(int descriptor, std::uint64_t offset, std::span<std::byte> into) {
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t count =
        ::pread(descriptor, into.data() + done, into.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

}  // namespace

Expected<std::unique_ptr<FileBytes>> FileBytes::open(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) return input_error(std::format("'{}' does not exist", path.string()));
  if (std::filesystem::is_directory(status)) {
    return input_error(std::format("'{}' is a folder; name the files in it", path.string()));
  }
  if (!std::filesystem::is_regular_file(status)) return input_error(std::format("'{}' is not a file", path.string()));
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return input_error(std::format("'{}' cannot be opened: {}", path.string(), std::strerror(errno)));
  const auto size = std::filesystem::file_size(path, code);
  return std::unique_ptr<FileBytes>(new FileBytes(descriptor, code ? 0 : size));
}

FileBytes::~FileBytes() { ::close(descriptor_); }

Bytes FileBytes::at(std::uint64_t offset, std::size_t count) {
  if (offset > size_ || count > size_ - offset) return {};
  if (offset < window_offset_ || offset + count > window_offset_ + window_count_) {
    const std::size_t wanted =
        std::max(count, static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, size_ - offset)));
    if (window_.size() < wanted) window_.resize(wanted);
    window_offset_ = offset;
    window_count_ = read_at(descriptor_, offset, std::span(window_).first(wanted));
    if (window_count_ < count) return {};
  }
  return Bytes(window_).subspan(offset - window_offset_, count);
}

}  // namespace pllit
