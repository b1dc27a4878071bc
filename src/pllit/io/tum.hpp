// Trajectories as TUM text: `t x y z qx qy qz qw`, seconds and metres, one pose a line, # for comments.
#pragma once

#include <filesystem>

#include "pllit/base/error.hpp"
#include "pllit/io/file.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// Reads a trajectory. Times keep their nanoseconds (they never pass through a double), quaternions are normalised.
/// Input errors name file and line: wrong number of columns, not a number, NaN, a quaternion more than 1 % from unit
/// length, times that do not ascend, a file without a pose.
Expected<Trajectory> read_tum(const std::filesystem::path& path);

/// The same for a file whose writer may have been killed: a last line without its end is ignored, and there may be no
/// pose at all.
Expected<Trajectory> read_interrupted_tum(const std::filesystem::path& path);

/// Writes all poses, nine decimals each. Fails as TumWriter does.
Expected<void> write_tum(const std::filesystem::path& path, const Trajectory& trajectory);

/// Writes a trajectory pose by pose; each row is in the file when append() returns.
class TumWriter {
 public:
  static Expected<TumWriter> create(const std::filesystem::path& path);

  /// Fails on a full disk, on a pose that is not finite and on a time that does not ascend; the file stays readable.
  Expected<void> append(const StampedPose& pose);
  Expected<void> close() { return file_.close(); }

 private:
  explicit TumWriter(OutputFile file) : file_(std::move(file)) {}

  OutputFile file_;
  std::optional<Time> last_;
};

}  // namespace pllit
