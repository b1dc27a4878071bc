// Point clouds as binary little-endian PLY; scalar fields are float properties under their own names.
#pragma once

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/file.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

/// Writes a whole cloud. Fails on a full disk and on a table that check_field_names or check_points refuses.
Expected<void> write_ply(const std::filesystem::path& path, const PointTable& table);

/// How the vertices of a binary little-endian PLY lie in its file.
struct PlyHeader {
  /// One number property of a vertex: where its bytes lie in a row, and how they become a float.
  struct Property {
    std::string name;
    std::size_t offset;
    float (*value)(const char* bytes);
  };
  std::size_t points = 0;
  std::size_t row_bytes = 0;
  std::size_t data_begin = 0;
  std::vector<Property> properties;
};

/// Reads the vertices of a binary little-endian PLY part by part: x, y, z and every other number property, converted to
/// float. Bytes after the last vertex are ignored. Input errors name the file and say what it holds instead.
class PlyReader {
 public:
  static Expected<PlyReader> open(const std::filesystem::path& path);

  /// The next points, at most so many; none at the end.
  Expected<PointTable> next(std::size_t most);
  std::size_t size() const { return header_.points; }

 private:
  PlyReader(std::filesystem::path path, std::ifstream stream, PlyHeader header)
      : path_(std::move(path)), stream_(std::move(stream)), header_(std::move(header)) {}

  std::filesystem::path path_;
  std::ifstream stream_;
  PlyHeader header_;
  std::size_t read_ = 0;
};

/// A cloud as a whole, or where it has more points than `most`, every n-th of them.
Expected<PointTable> read_ply(const std::filesystem::path& path,
                              std::size_t most = std::numeric_limits<std::size_t>::max());

/// Writes a cloud while it grows. The number of points in the header has a fixed width and is raised only after their
/// bytes are in the file, so whatever moment the process is killed at, the file opens and holds every append() before.
class PlyStream {
 public:
  static Expected<PlyStream> create(const std::filesystem::path& path, std::vector<std::string> fields);

  /// Adds points whose fields have the names given to create(), in that order. After an error (a full disk, a table
  /// that does not fit) the file holds what it held before.
  Expected<void> append(const PointTable& table);
  Expected<void> close() { return file_.close(); }

  std::size_t size() const { return points_; }

 private:
  PlyStream(OutputFile file, std::vector<std::string> fields, std::uint64_t count_offset)
      : file_(std::move(file)), fields_(std::move(fields)), count_offset_(count_offset) {}

  OutputFile file_;
  std::vector<std::string> fields_;
  std::uint64_t count_offset_;
  std::size_t points_ = 0;
};

}  // namespace pllit
