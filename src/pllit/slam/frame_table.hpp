// Frames and loops as plain values for writers: rows of health.csv and loops.csv, points of the map.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pllit/loop/correction.hpp"
#include "pllit/loop/loop_record.hpp"
#include "pllit/slam/odometry.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

using FrameCell = std::variant<double, std::int64_t, std::string>;

/// Names of the cells of health_row, in its order.
std::vector<std::string> health_columns();
/// What a frame showed: state and reasons, what was matched, how sure the pose is, and the time it took.
std::vector<FrameCell> health_row(const FrameEstimate& frame);

/// Names of the cells of loop_row, in its order.
std::vector<std::string> loop_columns();
/// What spoke for and against a candidate for a loop, and what became of it.
std::vector<FrameCell> loop_row(const LoopRecord& record);

/// Moves points where their frames went. `field` of the table tells when each was seen, in seconds since `start`.
void move_points(PointTable& points, std::string_view field, Time start, const Correction& correction,
                 const Trajectory& odometry);

/// Turns frames into the map that is written: each voxel of the world gives its first point, in W.
class MapRecorder {
 public:
  MapRecorder(double voxel_m, double radius_m) : fresh_(voxel_m, radius_m) {}

  static std::vector<std::string> fields() { return {"intensity", "time"}; }
  /// Points of this frame that fall into voxels not yet seen. Field `time` counts seconds since the first frame.
  PointTable new_points(const FrameEstimate& frame);

 private:
  FreshVoxels fresh_;
  std::optional<Time> first_;
};

}  // namespace pllit
