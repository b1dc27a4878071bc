#include "pllit/slam/vision.hpp"

#include <algorithm>
#include <cassert>
#include <format>
#include <utility>

#include "pllit/thermal/network_extractor.hpp"

namespace pllit {
namespace {

/// Cosine of the angle from the axis to the corner that is farthest from it, with some margin for what moves into view.
double cosine_of_corner(const Camera& camera) {
  constexpr double margin_rad = 0.05;
  double angle = 0.0;
  for (const double u : {0.0, camera.width - 1.0})
    for (const double v : {0.0, camera.height - 1.0}) {
      const Vector3d ray = camera.ray({u, v});
      angle = std::max(angle, std::atan2(ray.head<2>().norm(), ray.z()));
    }
  return std::cos(std::min(angle + margin_rad, M_PI));
}

MountMatrix prior_of_mount(const VisionConfig& config) {
  MountVector sigmas;
  sigmas << Vector3d::Constant(config.T_I_C_turn_deg * M_PI / 180.0), Vector3d::Constant(config.T_I_C_shift_m),
      config.delay_sigma_s, config.depth_stretch_sigma;
  return sigmas.cwiseAbs2().asDiagonal();
}

Expected<std::unique_ptr<FeatureExtractor>> make_extractor(const VisionConfig& config) {
  if (config.model == kClassical) return std::make_unique<ClassicalExtractor>(config.classical);
  NetworkConfig network;
  network.model = config.model;
  network.provider = config.provider;
  network.threads = config.threads;
  return NetworkExtractor::open(network);
}

}  // namespace

Vision::Vision(const Rig& rig, const VisionConfig& config, std::unique_ptr<FeatureExtractor> extractor)
    : rig_(rig),
      config_(config),
      extractor_(std::move(extractor)),
      least_cos_(cosine_of_corner(*rig.camera)),
      lines_(config.lines),
      clones_(without_poses({.T_I_C = rig.T_I_C}, prior_of_mount(config))) {}

void Vision::look_at(const CameraFrame& image) {
  looking_ = std::async(std::launch::async, [this, image] { return look(image); });
}

Expected<Vision::Look> Vision::look(const CameraFrame& image) const {
  Look look{.verdict = judge(image, history_, config_.check)};
  if (!look.verdict.usable()) return look;
  if (const auto fitting = fits(image.counts, *rig_.camera); !fitting) return std::unexpected(fitting.error());
  look.counts = one_channel(image.counts);
  look.chain = chain_;
  cv::Mat grey = look.counts;
  if (grey.depth() == CV_16U) {
    look.range = count_range(grey, range_, config_.grey);
    grey = mapped(grey, *look.range);
  }
  look.image = image_for_alignment(grey);  // a gain and a bias of its own suit each patch better than one curve all
  if (is_calibrated(look)) {
    if (look.verdict.after_shutter) look.chain = restarted(chain_, grey);
    grey = calibrated_image(grey, look.chain.curve);
  }
  auto features = extractor_->extract(grey);
  if (!features) return std::unexpected(features.error());
  look.features = std::move(*features);
  look.around = greys_around(look.counts, look.features.points_px);
  return look;
}

/// No clock keeps its distance to another for ever.
void Vision::let_clocks_drift(Time time) {
  constexpr double drift_s2_per_s = 1e-10;  // 0.08 ms in a minute, 0.6 ms in an hour, one sigma
  double& variance = clones_.covariance(mount_index::delay, mount_index::delay);
  if (mount_time_ != Time{}) variance += drift_s2_per_s * std::max(0.0, to_seconds(time - mount_time_));
  mount_time_ = time;
}

bool Vision::is_calibrated(const Look& look) const { return config_.photometric && look.counts.depth() == CV_8U; }

void Vision::add_points(const std::vector<Vector3f>& points_I, const SE3& T_W_I, Time time) {
  finish_learning();
  while (!points_.empty() && to_seconds(time - points_.front().time) > config_.depth_window_s) points_.pop_front();
  const SE3 T_C_I = mount().T_I_C.inverse();
  const Eigen::Matrix3f R_C_I = T_C_I.rotation().cast<float>();
  const Vector3f p_C_I = T_C_I.translation().cast<float>();
  const Matrix3d R_W_I = T_W_I.rotation();
  SeenPoints seen{.time = time, .points_W = {}};
  for (const Vector3f& p_I : points_I) {
    const Vector3f p_C = R_C_I * p_I + p_C_I;
    if (p_C.z() < static_cast<float>(least_cos_) * p_C.norm()) continue;
    seen.points_W.push_back((R_W_I * p_I.cast<double>() + T_W_I.translation()).cast<float>());
  }
  points_.push_back(std::move(seen));
}

Expected<Estimate> Vision::refine(const CameraFrame& image, const Moment& moment, ImageFacts& facts, StageClock& clock,
                                  Arena& arena) {
  assert(looking_.valid());
  finish_learning();
  auto look = looking_.get();
  clock.charge(Stage::features);
  facts.seen = true;
  if (!look) return std::unexpected(look.error());
  history_ = remembered(image, look->verdict, history_);
  facts.refused = look->verdict.reason;
  if (!look->verdict.usable()) return moment.prior;
  range_ = look->range;
  facts.points = static_cast<int>(look->features.points_px.size());

  let_clocks_drift(image.time);
  const SE3 T_W_C = exposure(moment.prior.mean, mount().delay_s, moment.rate_I).T_W_I * mount().T_I_C;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) keyframes_[i].T_W_C = clones_.poses[i] * mount().T_I_C;
  Tracks tracks =
      match_to_keyframes(look->features, look->image, T_W_C, keyframes_, *rig_.camera, config_.matching, arena);
  facts.matches = static_cast<int>(tracks.points.size());
  facts.anchored = static_cast<int>(std::ranges::count_if(tracks.points, [](const auto& m) { return m.line_px >= 0; }));
  clock.charge(Stage::track);

  if (is_calibrated(*look))
    chain_ = in_fresh_greys(advanced(look->chain, look->counts, look->around, tracks, keyframes_, config_.chain).chain,
                            keyframes_, config_.chain);
  facts.gain = chain_.curve.gain;
  facts.bias_grey = chain_.curve.bias;
  clock.charge(Stage::photometric);

  const Estimate posterior = update(moment, observe(look->features, tracks, moment), facts);
  const Exposure exposed = exposure(posterior.mean, mount().delay_s, moment.rate_I);
  lesson_ = Lesson{std::move(*look), std::move(tracks), posterior, exposed};
  clock.charge(Stage::thermal);
  return posterior;
}

void Vision::learn(Arena& arena) {
  if (!lesson_) return;
  learning_ = std::async(std::launch::async, [this, &arena, lesson = *std::exchange(lesson_, std::nullopt)] {
    extend_maps(lesson, arena);
  });
}

void Vision::finish_learning() {
  if (learning_.valid()) learning_.get();
}

void Vision::carry(const Matrix18& J_now_before) {
  finish_learning();
  pllit::carry(clones_, J_now_before);
}

/// Sightings of lines, and a keyframe, where it is time for them: both need the depth of what the image shows.
void Vision::extend_maps(const Lesson& lesson, Arena& arena) {
  const auto& [look, tracks, posterior, exposed] = lesson;
  const Time time = posterior.mean.time;
  const bool keyframe = wants_keyframe(tracks, keyframes_, look.features, time, rig_.camera->width, config_.keyframes);
  const bool lines = config_.residuals.lines && (keyframe || time - lines_seen_ >= config_.line_spacing);
  if (!keyframe && !lines) return;
  const SE3 T_W_C = exposed.T_W_I * mount().T_I_C;
  const DepthImage depths = depths_at(T_W_C);
  if (lines) {
    lines_.add(look.features, tracks, depths, T_W_C, *rig_.camera, arena);
    lines_seen_ = time;
  }
  if (!keyframe) return;
  if (std::ssize(keyframes_) >= config_.keyframes.most) drop_keyframe(expendable(tracks, keyframes_));
  keep(lesson, depths, arena);
}

ImageObservations Vision::observe(const Features& features, const Tracks& tracks, const Moment& moment) const {
  ImageObservations observations{.rate_I = moment.rate_I, .points = {}, .lines = {}};
  for (const PointTrack& track : tracks.tracked) {
    const Keyframe& keyframe = keyframes_[track.keyframe];
    const auto reference = static_cast<std::size_t>(track.reference);
    const FeatureDepth& depth = *keyframe.depths[reference];
    const Vector3d ray_K = rig_.camera->ray(keyframe.features.points_px[reference].cast<double>());
    observations.points.push_back(
        {.keyframe = track.keyframe,
         .p_K_m = depth.range_m * ray_K,
         .sigma_ray_m = depth.sigma_m,
         .observed_px = track.at_px.cast<double>(),
         .sigma_px = track.aligned ? config_.residuals.aligned_sigma_px : config_.residuals.point_sigma_px,
         .line_px = track.line_px});
  }
  if (config_.residuals.lines)
    observations.lines = nearest_of_each(lines_.observed(features, tracks, keyframes_),
                                         exposure(moment.prior.mean, mount().delay_s, moment.rate_I).T_W_I,
                                         clones_.poses, mount().T_I_C, *rig_.camera);
  return observations;
}

DepthImage Vision::depths_at(const SE3& T_W_C) const {
  std::vector<std::span<const Vector3f>> scans_W;
  for (const SeenPoints& seen : points_) scans_W.emplace_back(seen.points_W);
  return {scans_W, T_W_C.inverse(), *rig_.camera, config_.depth};
}

/// Stage II of the paper's sequential filter; an image whose innovation contradicts the prior is not believed at all.
Estimate Vision::update(const Moment& moment, const ImageObservations& observations, ImageFacts& facts) {
  const Estimate& prior = moment.prior;
  const Eigen::MatrixXd covariance = joint_covariance(prior, clones_);
  const auto linearize = [&](const NavState& state, const CameraMount& mount) {
    return linearize_image(state, mount, clones_.poses, observations, *rig_.camera, config_.residuals, covariance);
  };
  JointUpdate result = iterated_update(prior, clones_, linearize, FilterConfig{});
  facts.lines = static_cast<int>(observations.lines.size());
  facts.candidates = result.last.candidates;
  facts.inliers = result.last.inliers;
  if (facts.inliers < config_.least_inliers) return prior;
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(covariance.rows());
  moved.head<joint_index::clones>() << boxminus(result.posterior.mean, prior.mean),
      boxminus(result.clones.mount, mount());
  const Innovation news = innovation(result.last, moved, covariance);
  facts.misfit = news.misfit;
  if (news.misfit > config_.most_misfit) {
    facts.refused = std::format("residuals are {:.1f} times what their noise explains", news.misfit);
    return prior;
  }
  correction_ += 0.03 * (news.correction - correction_);
  facts.correction = correction_;
  facts.used = true;
  facts.information = result.last.H.topLeftCorner<6, 6>();
  clones_ = std::move(result.clones);
  return result.posterior;
}

void Vision::keep(const Lesson& lesson, const DepthImage& depths, Arena& arena) {
  const auto& [look, tracks, posterior, exposed] = lesson;
  Keyframe keyframe{.id = next_id_++, .time = posterior.mean.time, .T_W_C = exposed.T_W_I * mount().T_I_C};
  keyframe.features = strongest(look.features, config_.keyframes.most_points);
  keyframe.image = look.image;
  const std::vector<Eigen::Vector2f>& pixels_px = keyframe.features.points_px;
  keyframe.depths.resize(pixels_px.size());
  arena.for_chunks(pixels_px.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) keyframe.depths[i] = depths.at(pixels_px[i].cast<double>());
  });
  std::vector<Vector3d> points_K;
  for (std::size_t i = 0; i < pixels_px.size(); ++i)
    if (const auto& found = keyframe.depths[i])
      points_K.push_back(found->range_m * rig_.camera->ray(pixels_px[i].cast<double>()));
  const cv::Mat around = look.around.rowRange(0, static_cast<int>(pixels_px.size()));
  set_greys(keyframe, around, is_calibrated(look) ? chain_.curve : GreyCurve{});
  add_clone(clones_, posterior, exposed);
  clones_.covariance.bottomRightCorner<6, 6>() +=
      keyframe_noise(points_K, mount().T_I_C, *rig_.camera, config_.residuals.point_sigma_px);
  keyframes_.push_back(std::move(keyframe));
  if (config_.residuals.lines) lines_.keep();
}

Expected<std::unique_ptr<Vision>> make_vision(const Rig& rig, const VisionConfig& config) {
  if (!rig.camera || !config.enabled) return nullptr;
  auto extractor = make_extractor(config);
  if (!extractor) return in_context("features.model", extractor.error());
  return std::make_unique<Vision>(rig, config, std::move(*extractor));
}

void Vision::drop_keyframe(std::size_t index) {
  keyframes_.erase(keyframes_.begin() + static_cast<std::ptrdiff_t>(index));
  remove_clone(clones_, index);
  if (config_.residuals.lines) lines_.drop(index);
}

void Vision::restart() {
  finish_learning();
  keyframes_.clear();
  clones_ = without_poses(mount(), clones_.mount_covariance());
  lines_.restart();
  points_.clear();
}

}  // namespace pllit
