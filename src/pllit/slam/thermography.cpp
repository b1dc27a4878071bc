#include "pllit/slam/thermography.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <opencv2/core.hpp>

#include "pllit/base/evenly.hpp"

namespace pllit {
namespace {

/// An image through a function of its numbers, CV_32FC1.
template <class Pixel, class Function>
cv::Mat mapped(const cv::Mat& raw, const Function& function) {
  double least = 0.0, most = 0.0;
  cv::minMaxLoc(raw, &least, &most);
  const auto first = static_cast<int>(least);
  std::vector<float> table(static_cast<std::size_t>(static_cast<int>(most) - first + 1));
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<float>(function(least + static_cast<double>(i)));
  cv::Mat result(raw.size(), CV_32FC1);
  for (int row = 0; row < raw.rows; ++row) {
    const Pixel* in = raw.ptr<Pixel>(row);
    float* out = result.ptr<float>(row);
    for (int column = 0; column < raw.cols; ++column) out[column] = table[static_cast<std::size_t>(in[column] - first)];
  }
  return result;
}

template <class Function>
cv::Mat image_through(const cv::Mat& raw, const Function& function) {
  return raw.depth() == CV_8U ? mapped<std::uint8_t>(raw, function) : mapped<std::uint16_t>(raw, function);
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int row = 0; row < a.rows; ++row)
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0) return false;
  return true;
}

/// How far from where it should an image may show a point, as the refinement of the camera's pose leaves it open.
double aim_sigma_px(const RefinedMount& mount, const Camera& camera) {
  const Vector3d turn_rad = mount.covariance.diagonal().segment<3>(mount_index::theta).cwiseSqrt();
  return std::max(std::max(camera.fx, camera.fy) * turn_rad.head<2>().maxCoeff(),
                  0.5 * std::max(camera.width, camera.height) * turn_rad.z());
}

/// All that lies in a view, and of the rest one point in so many.
std::vector<Vector3f> thinned_outside(const ViewFrustum& view, const std::vector<Vector3f>& points_W,
                                      std::size_t share) {
  std::vector<Vector3f> kept_W;
  for (std::size_t i = 0; i < points_W.size(); ++i)
    if (i % share == 0 || view.contains(points_W[i].cast<double>())) kept_W.push_back(points_W[i]);
  return kept_W;
}

}  // namespace

std::optional<ThermographyInput> thermography_input(const FrameEstimate& frame, const Rig& rig,
                                                    const PlaneMap& planes) {
  if (!frame.image || !rig.camera) return std::nullopt;
  const cv::Mat& counts = frame.image->counts;
  if (counts.cols != rig.camera->width || counts.rows != rig.camera->height || counts.channels() != 1)
    return std::nullopt;
  return ThermographyInput{.time = frame.posterior.mean.time,
                           .T_W_C = frame.posterior.mean.T_W_I() * frame.T_I_C,
                           .raw = counts,
                           .points_W = frame.points_W(),
                           .planes = &planes,
                           .trusted = frame.health.state == HealthState::good,
                           .aim_sigma_px = frame.mount ? aim_sigma_px(*frame.mount, *rig.camera) : 0.0};
}

Thermography::Thermography(const Camera& camera, const ThermographyConfig& config)
    : camera_(camera),
      config_(config),
      map_(config.map),
      sights_(config.sights),
      detector_(config.anomalies),
      surface_(config.surface) {
  if (config.unit == IntensityUnit::kelvin && config.radiometry.corrects()) radiometric_.emplace(config.radiometry);
}

ThermographyFrame Thermography::process(const ThermographyInput& input) {
  assert(input.raw.cols == camera_.width && input.raw.rows == camera_.height);
  using Use = ThermographyFrame::Use;
  if (!depth_) {
    *this = Thermography(camera_, by_unit(config_, unit_of(config_, input.raw.depth() == CV_8U)));
    depth_ = input.raw.depth();
  }
  if (input.raw.depth() != depth_) return {.use = Use::other_depth};
  ThermographyFrame frame;
  if (input.trusted) remember_scan(input);
  if (shutter_closed(input)) return {.use = Use::frozen};
  if (!input.trusted) return {.use = Use::untrusted};

  const auto unit = [&](double raw) {
    if (config_.unit == IntensityUnit::kelvin) return config_.kelvin_at_zero + config_.kelvin_per_count * raw;
    return raw;
  };
  const SurfacePoints points = surface_in_view(input);
  const std::optional<Smear> smear = smear_of(input);
  ThermalView view{.time = input.time, .viewpoint_W = input.T_W_C.translation()};
  view.observations = sample_image(points, input.T_W_C, camera_, {image_through(input.raw, unit), input.raw},
                                   sampling_of(input), smear);
  if (radiometric_)
    for (SurfaceObservation& seen : view.observations)
      seen.intensity = static_cast<float>(radiometric_->object_K(seen.intensity, seen.range_m));
  frame.observations = static_cast<int>(view.observations.size());
  if (!tie_to_map(view.observations, frame)) return frame;
  view.spread = frame.anchor.spread;

  for (SurfaceObservation& observation : view.observations) {
    const double seen = observation.intensity, radius2 = squared_radius(observation.pixel_px, camera_);
    const double tied = anchor_(seen, radius2);
    observation.dip = static_cast<float>(tied - anchor_(seen - static_cast<double>(observation.dip), radius2));
    observation.rise = static_cast<float>(anchor_(seen + static_cast<double>(observation.rise), radius2) - tied);
    observation.intensity = static_cast<float>(tied);
    observation.doubt = static_cast<float>(anchor_.doubt(seen, radius2));
    observation.saturated = input.raw.depth() == CV_8U && observation.raw >= config_.saturated_grey;
  }
  const std::vector<VoxelKey> seen = map_.integrate(view);
  if (frame.use == Use::mapped && !sight_.range_mm.empty()) {
    detector_.update({.map = map_, .seen = seen, .sight = sight_, .past = sights_, .spread = view.spread}, view);
    sights_.add(sight_);
    keep_crops(input);
  }
  for (const Anomaly& anomaly : detector_.anomalies())
    if (anomaly.confirmed == input.time) frame.confirmed.push_back(anomaly.id);
  map_.trim();
  return frame;
}

/// Video stands still while the shutter is closed, to the last pixel.
bool Thermography::shutter_closed(const ThermographyInput& input) {
  const bool frozen = same_pixels(input.raw, last_raw_);
  input.raw.copyTo(last_raw_);
  if (frozen) shutter_ = input.time;
  return shutter_ && to_seconds(input.time - *shutter_) < config_.shutter_pause_s;
}

/// While the camera's pose on the rig is being found out, a point may be read off where it is by more than usual.
SamplingConfig Thermography::sampling_of(const ThermographyInput& input) const {
  constexpr double kSigmas = 3.0, kMost = 3.0;
  SamplingConfig sampling = config_.sampling;
  const double aim_px = std::min(kSigmas * input.aim_sigma_px, kMost * sampling.aim_px);
  sampling.aim_px = std::max(sampling.aim_px, static_cast<int>(std::ceil(aim_px)));
  return sampling;
}

/// Surfaces stay in memory for a while, but not where the last scans see through them. What the camera is not turned to
/// is to be known when it turns there, so it is followed too, but by fewer points and less often.
void Thermography::remember_scan(const ThermographyInput& input) {
  constexpr double kTurn_rad = 0.26;  // before the next image
  constexpr std::size_t kBehind = 6;
  if (input.points_W.empty()) return;
  const double reach_m = config_.sampling.max_range_m, everywhere_m = std::numeric_limits<double>::infinity();
  const ViewFrustum view = view_frustum(input.T_W_C, camera_, reach_m),
                    near_view = view_frustum(input.T_W_C, camera_, everywhere_m, kTurn_rad);
  scans_.push_back(evenly(input.points_W, static_cast<std::size_t>(config_.scan_points)));
  while (static_cast<int>(scans_.size()) > config_.scans) scans_.pop_front();
  surface_.add(thinned_outside(near_view, scans_.back(), kBehind), view.apex_W, input.time);
  const bool whole = sights_.is_due(input.time, view.apex_W);
  std::vector<Vector3f> fresh_W;
  for (const auto& scan_W : scans_)
    std::ranges::copy_if(scan_W, std::back_inserter(fresh_W),
                         [&](const Vector3f& p_W) { return whole || near_view.contains(p_W.cast<double>()); });
  sight_ = sight_of(input.time, view.apex_W, fresh_W, config_.sights);
  const RecentSurface::Parts parts{.view = 2, .rest = whole ? 4u : 0u};
  for (const Vector3d& p_W : surface_.carve(sight_, config_.sights, view, parts)) map_.forget(p_W);
}

/// By the motion since the image before.
std::optional<Smear> Thermography::smear_of(const ThermographyInput& input) {
  constexpr double kOneMotion_s = 0.5;
  const auto before = std::exchange(last_pose_, std::pair{input.time, input.T_W_C});
  const double since_s = before ? to_seconds(input.time - before->first) : 0.0;
  if (since_s <= 0.0 || since_s > kOneMotion_s || config_.time_constant_s <= 0.0) return std::nullopt;
  const double share = config_.time_constant_s / since_s;
  const SE3 back = input.T_W_C.inverse() * before->second;
  return Smear{input.T_W_C * pose_from(exp_so3(share * log_so3(back.asSO3())), share * back.translation()),
               static_cast<float>(config_.map.model.min_change / 3.0)};
}

SurfacePoints Thermography::surface_in_view(const ThermographyInput& input) {
  std::map<std::array<VoxelKey, 2>, std::optional<PlanePatch>> planes;  // neighbouring points share theirs
  const auto normal_at = [&](const Vector3d& p_W) -> Vector3f {
    if (!input.planes) return Vector3f::Zero();
    const auto [at, is_new] = planes.try_emplace(input.planes->window_at(p_W).corners, std::nullopt);
    if (is_new) at->second = input.planes->plane_at(p_W);
    const std::optional<PlanePatch>& plane = at->second;
    // What stands on a table is no part of its top, though the table is all that is known around there.
    if (!plane || std::abs(plane->distance_m(p_W)) > config_.surface.voxel_m) return Vector3f::Zero();
    return plane->normal_W().cast<float>();
  };
  return surface_.points(view_frustum(input.T_W_C, camera_, config_.sampling.max_range_m), normal_at);
}

void Thermography::keep_crops(const ThermographyInput& input) {
  for (const Anomaly& anomaly : detector_.anomalies()) {
    if (!anomaly.crop || anomaly.crop->time != input.time) continue;
    const ImageCrop& crop = *anomaly.crop;
    const cv::Rect part = cv::Rect(crop.left, crop.top, crop.width, crop.height) & cv::Rect({}, input.raw.size());
    if (!part.empty()) crops_[anomaly.id] = input.raw(part).clone();
  }
}

/// Finds the curve from this image's intensities to the map's; false where the image must not be used.
bool Thermography::tie_to_map(const std::vector<SurfaceObservation>& observations, ThermographyFrame& frame) {
  using Use = ThermographyFrame::Use;
  constexpr std::size_t kEnough = 5000;  // more add nothing but time: neighbours say the same
  const std::vector<AnchorPair> pairs = anchor_pairs(map_, evenly(observations, kEnough), camera_);
  frame.anchor = anchor_curve(pairs, anchor_, config_.anchor);
  if (frame.anchor.holds) {
    anchor_ = frame.anchor.curve;
    return true;
  }
  // Too few known surfaces: the last curve is the best guess, and at the start any curve will do.
  frame.use = frame.anchor.pairs < config_.anchor.min_pairs ? Use::learned : Use::contradicts;
  return frame.use == Use::learned;
}

PointTable Thermography::anomaly_points() const {
  PointTable table{.points = {}, .fields = {{"id", {}}, {"change", {}}, {"change_sigmas", {}}, {"seen_s", {}}}};
  std::vector<std::uint32_t> alarms;
  for (const Anomaly& anomaly : detector_.anomalies())
    if (anomaly.confirmed) alarms.push_back(anomaly.id);
  for (const auto& [key, watched] : detector_.watch()) {
    if (!std::ranges::binary_search(alarms, watched.owner)) continue;
    table.points.push_back(watched.position_W.cast<float>());
    table.fields[0].values.push_back(static_cast<float>(watched.owner));
    table.fields[1].values.push_back(watched.peak);
    table.fields[2].values.push_back(watched.peak / watched.sigma);
    table.fields[3].values.push_back(static_cast<float>(to_seconds(watched.last - map_.start().value_or(Time{}))));
  }
  return table;
}

}  // namespace pllit
