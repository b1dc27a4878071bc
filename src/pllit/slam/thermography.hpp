// The thermographic stage: after an image's pose is known, its intensities go into the map, and what is abnormally hot
// is told.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pllit/slam/odometry.hpp"
#include "pllit/slam/thermography_config.hpp"

namespace pllit {

/// One image with what belongs to it.
struct ThermographyInput {
  Time time;
  SE3 T_W_C = SE3::Identity();       ///< at that time
  cv::Mat raw{};                     ///< CV_8UC1 or CV_16UC1, of the camera's size; the anchor calibrates it
  std::vector<Vector3f> points_W{};  ///< the scan that ends with it, or empty
  const PlaneMap* planes = nullptr;  ///< for the surfaces' normals; none: not known
  bool trusted = true;               ///< localisation is good
  double aim_sigma_px = 0.0;         ///< how well it is known where the image shows a point, one sigma
};

/// The input that a frame of the odometry gives; nothing where its image cannot be used: of another size than the rig's
/// camera, or in colour.
std::optional<ThermographyInput> thermography_input(const FrameEstimate& frame, const Rig& rig, const PlaneMap& planes);

/// What an image came to.
struct ThermographyFrame {
  enum class Use {
    mapped,       ///< learned from and searched
    learned,      ///< learned from, but not tied to the map, so not searched
    untrusted,    ///< not used: localisation was degraded
    frozen,       ///< not used: the shutter was closed, or has just opened
    contradicts,  ///< not used: its greys do not fit to the map's by any curve
    other_depth   ///< not used: other bits a pixel than the first one, so of another stream
  };
  Use use = Use::mapped;
  AnchorFit anchor{};
  int observations = 0;
  std::vector<std::uint32_t> confirmed{};  ///< anomalies that this image confirmed
};

class Thermography {
 public:
  /// The first image tells the unit, where the configuration leaves it open, and with it what suits it (by_unit).
  Thermography(const Camera& camera, const ThermographyConfig& config);

  /// Takes the next image; times ascend.
  ThermographyFrame process(const ThermographyInput& input);

  const ThermalMap& map() const { return map_; }
  std::vector<Anomaly> anomalies() const { return detector_.anomalies(); }
  /// The hot points of all anomalies that are or were alarms, what the paper marks red, with fields `id`, `change`,
  /// `change_sigmas` and `seen_s` (last seen hot, since the map's start).
  PointTable anomaly_points() const;
  /// Of each anomaly the part of an image in which it is largest (Anomaly::crop), as the camera gave it.
  const std::map<std::uint32_t, cv::Mat>& crops() const { return crops_; }
  std::size_t watched() const { return detector_.watch().size(); }
  /// As the first image has settled it.
  const ThermographyConfig& config() const { return config_; }

 private:
  bool shutter_closed(const ThermographyInput& input);
  SamplingConfig sampling_of(const ThermographyInput& input) const;
  void remember_scan(const ThermographyInput& input);
  SurfacePoints surface_in_view(const ThermographyInput& input);
  std::optional<Smear> smear_of(const ThermographyInput& input);
  void keep_crops(const ThermographyInput& input);
  bool tie_to_map(const std::vector<SurfaceObservation>& observations, ThermographyFrame& frame);

  Camera camera_;
  ThermographyConfig config_;
  std::optional<RadiometricEquation> radiometric_;  // none where apparent temperatures, or greys, are kept
  ThermalMap map_;
  SightLog sights_;
  AnomalyDetector detector_;
  AnchorCurve anchor_;
  RecentSurface surface_;
  std::deque<std::vector<Vector3f>> scans_;
  Sight sight_;  ///< of these
  cv::Mat last_raw_;
  std::optional<std::pair<Time, SE3>> last_pose_;  // T_W_C
  std::map<std::uint32_t, cv::Mat> crops_;
  std::optional<int> depth_;     ///< of the images, as OpenCV counts it; none before the first
  std::optional<Time> shutter_;  ///< last image that was frozen
};

}  // namespace pllit
