#include "pllit/io/file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <format>
#include <fstream>
#include <system_error>
#include <utility>

namespace pllit {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

std::unexpected<Error> cannot_write(const std::filesystem::path& path, int error) {
  return failure(std::format("cannot write {}: {}", path.string(), reason(error)));
}

}  // namespace

Expected<OutputFile> OutputFile::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return failure(std::format("cannot create {}: {}", path.string(), reason(errno)));
  return OutputFile(path, descriptor);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Expected<void> OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return cannot_write(path_, errno);
    size_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Expected<void> OutputFile::write_at(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return cannot_write(path_, errno);
    offset += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

void OutputFile::cut_to(std::uint64_t size) {
  const auto end = static_cast<off_t>(size);
  if (::ftruncate(descriptor_, end) == 0 && ::lseek(descriptor_, end, SEEK_SET) == end) size_ = size;
}

Expected<void> OutputFile::sync() {
  // Pipes and devices cannot be synchronised (EINVAL) and need not be.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) return cannot_write(path_, errno);
  return {};
}

Expected<void> OutputFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) return cannot_write(path_, errno);
  return {};
}

Expected<void> write_file(const std::filesystem::path& path, std::string_view bytes) {
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  if (auto written = file->write(bytes); !written) return written;
  return file->close();
}

std::filesystem::path part_path(const std::filesystem::path& path) { return path.string() + ".part"; }

Expected<void> put_in_place(const std::filesystem::path& path) {
  std::error_code status;
  // Renaming onto a device such as /dev/full would replace the device.
  if (std::filesystem::exists(path, status) && !std::filesystem::is_regular_file(path, status))
    return failure(std::format("cannot replace {}: it is not a regular file", path.string()));
  std::filesystem::rename(part_path(path), path, status);
  if (status) return cannot_write(path, status.value());
  return {};
}

Expected<void> replace_file(const std::filesystem::path& path, std::string_view bytes) {
  auto file = OutputFile::create(part_path(path));
  if (!file) return std::unexpected(file.error());
  auto written = file->write(bytes).and_then([&] { return file->sync(); }).and_then([&] { return file->close(); });
  if (!written) {
    std::error_code status;
    std::filesystem::remove(part_path(path), status);
    return written;
  }
  return put_in_place(path);
}

Expected<std::ifstream> open_file(const std::filesystem::path& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) return input_error(std::format("{}: no such file", path.string()));
  if (std::filesystem::is_directory(path, status))
    return input_error(std::format("{}: is a folder, expected a file", path.string()));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return input_error(std::format("{}: cannot be opened", path.string()));
  return stream;
}

Expected<std::string> read_file(const std::filesystem::path& path) {
  auto stream = open_file(path);
  if (!stream) return std::unexpected(stream.error());
  std::string bytes, chunk(std::size_t{1} << 20, '\0');
  while (stream->read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || stream->gcount() > 0)
    bytes.append(chunk, 0, static_cast<std::size_t>(stream->gcount()));
  if (stream->bad()) return input_error(std::format("{}: cannot be read", path.string()));
  return bytes;
}

}  // namespace pllit
