// Recordings: one or several ROS 1 bags as a source of sensor events.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/point_time.hpp"
#include "pllit/sensor/measurements.hpp"

namespace pllit {

struct BagOptions {
  std::string imu_topic{};  ///< empty: the only one of a fitting type, likewise below
  std::string lidar_topic{};
  std::string image_topic{};
  bool with_images = true;
  std::optional<TimeUnit> point_time_unit{};  ///< nothing: found from the scans
  bool scan_stamp_at_end = false;             ///< header stamps of scans are the end of the sweep
};

/// The topics that were chosen.
struct BagTopics {
  std::string imu;
  std::string lidar;
  std::optional<std::string> image{};
};

/// Delivers IMU samples, scans and images of one recording in the order received. Memory does not grow with the length
/// of the recording. Messages that cannot be decoded are skipped, counted and told in notes(); where the first 20 of a
/// topic are all bad, next() fails with the reason of the first. Stamps come from the message headers; where a header
/// has none (zero), from the time received.
class BagSource final : public EventSource {
 public:
  ~BagSource() override;
  Expected<std::optional<SensorEvent>> next() override;
  double progress() const override;
  std::vector<std::string> notes() const override;

  const BagTopics& topics() const;
  /// How the scans read so far carry point time; nothing before the first one that does.
  std::optional<TimeLayout> time_layout() const;

 private:
  friend Expected<std::unique_ptr<BagSource>> open_bags(const std::vector<std::filesystem::path>&, const BagOptions&);
  struct Impl;
  explicit BagSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Opens the bags of one recording, in any order; they are merged by time. A bag without index (its recorder was
/// killed) or with damaged parts gives what can be read, told in notes(). Errors: files that are no ROS 1 bags, and
/// topics that are missing or ambiguous.
Expected<std::unique_ptr<BagSource>> open_bags(const std::vector<std::filesystem::path>& paths,
                                               const BagOptions& options = {});

}  // namespace pllit
