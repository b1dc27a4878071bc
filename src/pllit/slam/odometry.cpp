#include "pllit/slam/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>

namespace pllit {

namespace ix = error_index;

namespace {

/// Of the directions that a scan does not observe, those of motion rather than of turning: orthonormal, in W.
Eigen::Matrix3Xd unobserved_shifts(const DegenerateDirections& unobserved) {
  constexpr double mostly = 0.7;
  Eigen::Matrix3Xd shifts(3, 0);
  for (Eigen::Index i = 0; i < unobserved.cols(); ++i) {
    Vector3d shift = unobserved.col(i).tail<3>();
    if (shift.norm() < mostly) continue;
    shift -= shifts * (shifts.transpose() * shift).eval();
    if (shift.norm() < 0.5 * mostly) continue;
    shifts.conservativeResize(Eigen::NoChange, shifts.cols() + 1);
    shifts.rightCols<1>() = shift.normalized();
  }
  return shifts;
}

/// The share of a scan's points that lie where the map has too few to match anything to.
double new_share(const PointCloud& scan, const SE3& T_W_I, const PlaneMap& map) {
  constexpr std::size_t stride = 4;
  std::size_t looked = 0, fresh = 0;
  for (std::size_t i = 0; i < scan.points_I.size(); i += stride, ++looked)
    fresh += map.knows(T_W_I.act(scan.points_I[i].cast<double>())) ? 0 : 1;
  return looked > 0 ? static_cast<double>(fresh) / static_cast<double>(looked) : 0.0;
}

/// Whether an image knows the pose, its keyframes taken as known, along every direction that the scan does not observe.
bool image_holds(const Matrix6& information, const DegenerateDirections& unobserved, const SO3& R_W_I) {
  constexpr double shift_sigma_m = 0.05, turn_sigma_rad = 0.003, counts = 0.3;
  const auto held = [](const Vector3d& direction, const Matrix3d& block, double sigma) {
    if (direction.norm() < counts) return true;
    const Vector3d unit = direction.normalized();
    return unit.dot(block * unit) * sigma * sigma > 1.0;
  };
  for (Eigen::Index i = 0; i < unobserved.cols(); ++i) {
    const Vector3d turn_I = R_W_I.inverse().act(unobserved.col(i).head<3>()), shift_W = unobserved.col(i).tail<3>();
    if (!held(turn_I, information.topLeftCorner<3, 3>(), turn_sigma_rad) ||
        !held(shift_W, information.bottomRightCorner<3, 3>(), shift_sigma_m))
      return false;
  }
  return true;
}

}  // namespace

Odometry::Odometry(const Rig& rig, const Config& config, std::unique_ptr<Vision> vision)
    : rig_(rig),
      config_(config),
      arena_(config.threads),
      map_(config.map),
      drift_(config.drift),
      vision_(std::move(vision)) {}

Expected<std::vector<FrameEstimate>> Odometry::process(SensorPacket packet) {
  waiting_.push_back(std::move(packet));
  if (!start_) {
    const auto start = try_start();
    if (!start) return std::unexpected(start.error());
    if (!*start) return std::vector<FrameEstimate>{};
    begin((*start)->still ? **start : with_settled_velocity(**start));
  }
  std::vector<FrameEstimate> frames;
  for (const SensorPacket& next : waiting_) {
    auto frame = step(next);
    if (!frame) return std::unexpected(frame.error());
    frames.push_back(std::move(*frame));
  }
  waiting_.clear();
  return frames;
}

/// The paper's method: propagation, LiDAR update, and from its posterior the thermal update; maps are written last.
Expected<FrameEstimate> Odometry::step(const SensorPacket& packet) {
  StageClock clock;
  FrameEstimate frame;
  FrameFacts& facts = frame.facts;
  const bool look = packet.image && vision_;
  if (look) vision_->look_at(*packet.image);

  const Propagation motion = propagate(estimate_, in_si_units(packet.imu), packet.end, rig_.imu, config_.gaps,
                                       packet.scan ? std::optional(packet.scan->start) : std::nullopt);
  clock.charge(Stage::propagate);

  PointCloud dense;
  SE3 T_W_scan = motion.predicted.mean.T_W_I();  // where the whole scan lies best
  if (packet.scan) {
    facts.has_scan = true;
    frame.cloud = deskew(*packet.scan, motion.path, rig_.T_I_L, rig_.lidar);
    dense = downsample(frame.cloud, config_.scan.insert_voxels * config_.map.voxel_m);
    const PointCloud sparse = thin(downsample(dense, config_.scan.match_voxels * config_.map.voxel_m,
                                              static_cast<std::size_t>(config_.scan.min_matched)),
                                   static_cast<std::size_t>(config_.scan.max_matched));
    clock.charge(Stage::deskew);

    // A map of less than half a scan, such as the first image cuts off, is no map yet.
    facts.map_empty = map_.voxels() == 0 || 2 * mapped_points_ < dense.points_I.size();
    const UpdateResult lidar = match(motion.sweep.estimate, sparse, facts);
    advance_to(at_end(motion, lidar));
    T_W_scan = lidar.posterior.mean.T_W_I();
    clock.charge(Stage::lidar);
  } else {
    advance_to({motion.predicted, motion.J_end_begin});
  }

  if (look) {
    vision_->add_points(frame.cloud.points_I, estimate_.mean.T_W_I(), packet.end);
    const Vector3d rate_I = motion.path.nodes.back().omega_I;
    const auto refined = vision_->refine(*packet.image, {estimate_, rate_I}, facts.image, clock, arena_);
    if (!refined) return std::unexpected(refined.error());
    T_W_scan = refined->mean.T_W_I() * estimate_.mean.T_W_I().inverse() * T_W_scan;
    estimate_ = *refined;
    if (facts.image.used && image_holds(facts.image.information, unobserved_, estimate_.mean.R_W_I))
      last_held_ = packet.end;
    frame.image = packet.image;
    frame.mount = {vision_->mount(), vision_->mount_covariance()};
    const Exposure exposed = exposure(estimate_.mean, vision_->mount().delay_s, rate_I);
    frame.T_I_C = estimate_.mean.T_W_I().inverse() * exposed.T_W_I * vision_->mount().T_I_C;
    vision_->learn(arena_);
  }
  facts.image.holds = to_seconds(packet.end - last_held_) < config_.health.silent_degraded_s;
  drift_.move_to(estimate_.mean.T_W_I());
  drift_.place(estimate_, unobserved_shifts(unobserved_), facts.image.holds);
  if (packet.scan) {
    extend_map(dense, T_W_scan, facts);
    clock.charge(Stage::map);
  }
  facts.speed_mps = estimate_.mean.v_W.norm();
  facts.since_match_s = to_seconds(packet.end - last_match_);
  facts.longest_imu_gap_s = to_seconds(motion.longest_gap);
  facts.allowed_imu_gap_s = to_seconds(config_.gaps.max_gap);
  frame.health = assess(facts, config_.health);
  frame.posterior = estimate_;
  frame.doubt = drift_.doubt();
  frame.stage_ms = clock.times_ms();
  return frame;
}

void Odometry::advance_to(const SmoothedEnd& end) {
  estimate_ = end.estimate;
  if (vision_) vision_->carry(end.J_end_begin);
}

UpdateResult Odometry::match(const Estimate& predicted, const PointCloud& points, FrameFacts& facts) {
  facts.points = static_cast<int>(points.points_I.size());
  UpdateResult result{.posterior = predicted, .last = {}};
  if (facts.map_empty) return result;

  PlaneResiduals residuals(points, map_, rig_, predicted.covariance.topLeftCorner<6, 6>(), config_.planes, arena_);
  DegenerateDirections unobserved;
  const auto linearize = [&](const NavState& state) {
    const ObservedEquations observed = observed_part(residuals(state), state.R_W_I, unobserved_, config_.degeneracy);
    facts.localizability = observed.localizability;
    unobserved = observed.unobserved;
    return observed.sums;
  };
  result = iterated_update(predicted, linearize, config_.filter);
  unobserved_ = unobserved;
  facts.candidates = result.last.candidates;
  facts.inliers = result.last.inliers;
  facts.iterations = result.iterations;
  facts.residual_rms_m = facts.inliers > 0 ? std::sqrt(result.last.squared_m2 / facts.inliers) : 0.0;
  facts.matched = match_accepted(result.last, config_.health);
  if (!facts.matched) return {.posterior = predicted, .last = result.last};
  return result;
}

void Odometry::extend_map(const PointCloud& points, const SE3& T_W_I, FrameFacts& facts) {
  unmatched_ = facts.matched || facts.map_empty ? 0 : unmatched_ + 1;
  if (unmatched_ >= config_.health.restart_after) {
    // The old map does not help any more. The new one begins at the predicted pose and inherits its error.
    facts.map_restarted = true;
    unmatched_ = 0;
    map_.clear();
    mapped_points_ = 0;
    unobserved_ = {};
    if (vision_) vision_->restart();
    drift_.restart(estimate_);
    estimate_.covariance.topRows<ix::pose_size>().setZero();
    estimate_.covariance.leftCols<ix::pose_size>().setZero();
    estimate_.covariance.topLeftCorner<ix::pose_size, ix::pose_size>() = 1e-10 * Matrix6::Identity();
  }
  if (unmatched_ > 0) return;  // a pose that does not fit the map must not enter it
  last_match_ = estimate_.mean.time;
  if (facts.matched) drift_.add_scan(new_share(points, T_W_I, map_));
  map_.insert(points, T_W_I);
  mapped_points_ += points.points_I.size();
  map_.slide(estimate_.mean.p_W);
}

Expected<std::optional<Start>> Odometry::try_start() const {
  std::vector<ImuSample> imu;
  for (const SensorPacket& packet : waiting_)
    for (const ImuSample& sample : packet.imu)
      if (imu.empty() || sample.time > imu.back().time) imu.push_back(sample);
  const double waited_s = to_seconds(waiting_.back().end - waiting_.front().end);
  if (waited_s > 10.0 + config_.start.window_s && imu.size() < 5)
    return input_error(
        std::format("{:.0f} s of scans came without IMU data; check the IMU topic and its clock", waited_s));
  auto start = start_up(imu, rig_.imu, config_.start);
  if (!start || !*start || (*start)->still || !(*start)->stillness.quiet || config_.start.mode == StartMode::moving)
    return start;
  // A quiet gyroscope with a mean rate is at rest and biased, or turns very evenly. Gravity cannot tell which about the
  // vertical, but the scans can.
  StartUpConfig any_bias = config_.start;
  any_bias.still_rate_rps = std::numeric_limits<double>::infinity();
  auto at_rest = start_up(imu, rig_.imu, any_bias);
  return scans_show_no_turn(**at_rest) ? at_rest : start;
}

/// A trial that takes the rig to be at rest and matches the waiting
/// scans to each other: do they turn as the gyroscope said?
bool Odometry::scans_show_no_turn(const Start& start) const {
  Odometry trial(rig_, config_);
  trial.begin(start);
  for (const SensorPacket& packet : waiting_)
    if (!trial.step(packet)) return false;
  const SO3 turned = start.estimate.mean.R_W_I.inverse() * trial.estimate_.mean.R_W_I;
  const double elapsed_s = to_seconds(trial.estimate_.mean.time - start.estimate.mean.time);
  return trial.unmatched_ == 0 && log_so3(turned).norm() < 0.25 * start.stillness.mean_rate_rps.norm() * elapsed_s;
}

void Odometry::begin(const Start& start) {
  start_ = start;
  estimate_ = start.estimate;
  last_match_ = start.estimate.mean.time;
}

/// A moving start knows no velocity, so its first scans cannot be de-skewed well. A trial odometry matches them to each
/// other, and what it finds is where the next trial begins, until the velocity stays.
Start Odometry::with_settled_velocity(Start start) const {
  constexpr std::size_t packets = 4;
  constexpr int trials = 6;
  constexpr double settled_mps = 0.03, settled_sigma_mps = 0.3;
  const Matrix3d prior = start.estimate.covariance.block<3, 3>(ix::v, ix::v);
  Matrix3d posterior = prior;
  for (int i = 0; i < trials; ++i) {
    Odometry trial(rig_, config_);
    trial.begin(start);
    Estimate by_imu = start.estimate;
    for (std::size_t k = 0; k < std::min(packets, waiting_.size()); ++k) {
      by_imu = propagate(by_imu, trial.in_si_units(waiting_[k].imu), waiting_[k].end, rig_.imu, config_.gaps).predicted;
      if (!trial.step(waiting_[k])) return start;
    }
    // Only what the scans have shown: along a corridor the velocity stays as unknown as it was.
    posterior = trial.estimate_.covariance.block<3, 3>(ix::v, ix::v);
    const Matrix3d shown = Matrix3d::Identity() - posterior * prior.inverse();
    const Vector3d change = shown * (trial.estimate_.mean.v_W - by_imu.mean.v_W);
    start.estimate.mean.v_W += change;
    if (change.norm() < settled_mps) break;
  }
  start.estimate.covariance.block<3, 3>(ix::v, ix::v) =
      posterior + settled_sigma_mps * settled_sigma_mps * Matrix3d::Identity();
  return start;
}

std::vector<ImuSample> Odometry::in_si_units(std::vector<ImuSample> imu) const {
  const double scale = mps2_per(start_->unit);
  for (ImuSample& sample : imu) sample.accel_mps2 *= scale;
  return imu;
}

std::vector<Vector3f> FrameEstimate::points_W() const {
  const Matrix3d R = posterior.mean.R_W_I.rotation();
  std::vector<Vector3f> points_W;
  points_W.reserve(cloud.points_I.size());
  for (const Vector3f& p_I : cloud.points_I)
    points_W.push_back((R * p_I.cast<double>() + posterior.mean.p_W).cast<float>());
  return points_W;
}

Matrix6 relative_pose_covariance(const FrameEstimate& a, const FrameEstimate& b) {
  return relative_covariance(a.doubt, b.doubt, b.posterior.mean.p_W - a.posterior.mean.p_W);
}

}  // namespace pllit
