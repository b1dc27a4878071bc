#include "pllit/thermal/visual_residuals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using test::Random;

/// A corridor along x that a rig has moved through, with what its camera sees.
struct Corridor {
  Rig rig;
  NavState now;
  std::vector<SE3> keyframes;
  ImageObservations seen;

  CameraMount mount() const { return {.T_I_C = rig.T_I_C}; }
};

constexpr Eigen::Index kJoint = joint_index::clone(3);

struct Noise {
  double pixel_px = 1.0, depth_m = 0.03, line_m = 0.01;
  double false_share = 0.0;
};

Vector3d wall_point(Random& random, double x) {
  const double across = random.uniform(-1.2, 1.2);
  switch (static_cast<int>(random.uniform(0.0, 4.0))) {
    case 0:
      return {x, -1.2, across};
    case 1:
      return {x, 1.2, across};
    case 2:
      return {x, across, -1.2};
    default:
      return {x, across, 1.2};
  }
}

Vector2d pixel_noise(Random& random, const Noise& noise) {
  return {random.normal(noise.pixel_px), random.normal(noise.pixel_px)};
}

void add_points(Corridor& corridor, Random& random, const Noise& noise, int per_keyframe) {
  const Camera& camera = *corridor.rig.camera;
  const SE3 T_C_W = (corridor.now.T_W_I() * corridor.rig.T_I_C).inverse();
  for (std::size_t k = 0; k < corridor.keyframes.size(); ++k) {
    const SE3 T_K_W = (corridor.keyframes[k] * corridor.rig.T_I_C).inverse();
    for (int found = 0; found < per_keyframe;) {
      const Vector3d p_W = wall_point(random, corridor.now.p_W.x() + random.uniform(1.0, 12.0));
      const auto then = camera.project(T_K_W.act(p_W)), now = camera.project(T_C_W.act(p_W));
      if (!then || !now || !test::in_image(*then, camera) || !test::in_image(*now, camera)) continue;
      ++found;
      const Vector3d p_K = T_K_W.act(p_W);
      const bool wrong = random.uniform(0.0, 1.0) < noise.false_share;
      const Vector2d anywhere(random.uniform(0.0, camera.width), random.uniform(0.0, camera.height));
      corridor.seen.points.push_back({.keyframe = k,
                                      .p_K_m = p_K + random.normal(noise.depth_m) * p_K.normalized(),
                                      .sigma_ray_m = noise.depth_m,
                                      .observed_px = wrong ? anywhere : *now + pixel_noise(random, noise),
                                      .line_px = found % 3 == 0 ? random.uniform(0.0, 3.0) : -1.0});
    }
  }
}

/// Door frames: upright lines of a metre on both walls.
void add_lines(Corridor& corridor, Random& random, const Noise& noise, int count) {
  const Camera& camera = *corridor.rig.camera;
  const SE3 T_C_W = (corridor.now.T_W_I() * corridor.rig.T_I_C).inverse();
  for (int found = 0; found < count;) {
    const double x = corridor.now.p_W.x() + random.uniform(2.0, 8.0), y = random.uniform(0.0, 1.0) < 0.5 ? -1.2 : 1.2;
    const Vector3d a_W(x, y, -0.5), b_W(x, y, 0.5);
    const auto a = camera.project(T_C_W.act(a_W)), b = camera.project(T_C_W.act(b_W));
    if (!a || !b || !test::in_image(*a, camera) || !test::in_image(*b, camera)) continue;
    ++found;
    const auto shifted = [&](const Vector3d& p_W) {
      return Vector3d(p_W + Vector3d(random.normal(noise.line_m), random.normal(noise.line_m), 0.0));
    };
    const auto keyframe = static_cast<std::size_t>(found) % corridor.keyframes.size();
    const SE3 T_K_W = (corridor.keyframes[keyframe] * corridor.rig.T_I_C).inverse();
    corridor.seen.lines.push_back({.keyframe = keyframe,
                                   .line_K = T_K_W * test::landmark_between(shifted(a_W), shifted(b_W), noise.line_m),
                                   .start_px = *a + pixel_noise(random, noise),
                                   .end_px = *b + pixel_noise(random, noise)});
  }
}

Corridor corridor_of(Random& random, const Noise& noise, int points_per_keyframe = 40, int lines = 6) {
  Corridor corridor;
  corridor.rig.camera = test::thermal_camera();
  corridor.rig.T_I_C = test::camera_ahead();
  for (const double x : {0.0, 0.5, 1.0})
    corridor.keyframes.push_back(pose_from(exp_so3(random.vector(0.03)), Vector3d(x, 0.0, 0.0) + random.vector(0.05)));
  corridor.now.R_W_I = exp_so3(random.vector(0.03));
  corridor.now.p_W = Vector3d(1.6, 0.0, 0.0) + random.vector(0.05);
  add_points(corridor, random, noise, points_per_keyframe);
  add_lines(corridor, random, noise, lines);
  return corridor;
}

SE3 moved(const SE3& T_W_I, const Vector6& error) {
  return pose_from(T_W_I.asSO3() * exp_so3(error.head<3>()), T_W_I.translation() + error.tail<3>());
}

/// Residuals say all that they can.
VisualConfig unbounded(VisualConfig config) {
  config.max_information = config.common_shift_m = 0.0;
  return config;
}

/// What a joint error is added to.
struct Point {
  NavState now;
  CameraMount mount;
  std::vector<SE3> keyframes;
};

Point point_of(const Corridor& corridor) { return {corridor.now, corridor.mount(), corridor.keyframes}; }

Point moved(Point point, const VectorXd& error) {
  point.now = boxplus(point.now, error.head<18>());
  point.mount = boxplus(point.mount, error.segment<mount_index::size>(joint_index::mount));
  for (std::size_t k = 0; k < point.keyframes.size(); ++k)
    point.keyframes[k] = moved(point.keyframes[k], error.segment<6>(joint_index::clone(k)));
  return point;
}

JointEquations linearized(const Point& at, const Corridor& corridor, const VisualConfig& config,
                          const MatrixXd& search = {}) {
  return linearize_image(at.now, at.mount, at.keyframes, corridor.seen, *corridor.rig.camera, config, search);
}

TEST(VisualResiduals, GradientMatchesCentralDifferencesOfTheCost) {
  Random random(31);
  // Without doubt about depths and lines, whose say in the noise changes with the pose.
  Corridor corridor = corridor_of(random, {.depth_m = 0.0, .line_m = 0.0, .false_share = 0.2});
  corridor.now.v_W = Vector3d(1.5, 0.2, -0.1);
  corridor.seen.rate_I = Vector3d(0.3, -0.2, 0.8);
  const VisualConfig config = unbounded({.gate = 1e9});
  Point point = point_of(corridor);
  point.mount.delay_s = 0.003;
  const JointEquations at = linearized(point, corridor, config);
  EXPECT_EQ(at.inliers, 126);
  for (Eigen::Index i = 0; i < kJoint; ++i) {
    const auto cost = [&](double step) {
      return linearized(moved(point, step * VectorXd::Unit(kJoint, i)), corridor, config).cost;
    };
    const double slope = (cost(1e-6) - cost(-1e-6)) / 2e-6;
    EXPECT_NEAR(slope, -2.0 * at.b[i], 1e-4 * at.b.norm()) << i;
  }
}

TEST(VisualResiduals, InformationIsThatOfAllResidualsStackedUp) {
  Random random(32);
  const Corridor corridor = corridor_of(random, {.depth_m = 0.0, .line_m = 0.0});
  const VisualConfig config = unbounded({.point_sigma_px = 1.3, .line_sigma_px = 1.3, .loss = 1e6, .weights = false});
  const JointEquations at =
      linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera, config);
  // One residual at a time: b of a problem with one residual r and weight W is -J'Wr, squared is r'Wr.
  MatrixXd H = MatrixXd::Zero(kJoint, kJoint);
  VectorXd b = VectorXd::Zero(kJoint);
  double cost = 0.0;
  const auto add = [&](const ImageObservations& one) {
    const JointEquations part =
        linearize_image(corridor.now, corridor.mount(), corridor.keyframes, one, *corridor.rig.camera, config);
    H += part.H;
    b += part.b;
    cost += part.cost;
  };
  for (const PointObservation& point : corridor.seen.points) add({.points = {point}, .lines = {}});
  for (const LineObservation& line : corridor.seen.lines) add({.points = {}, .lines = {line}});
  EXPECT_LT((at.H - H).norm(), 1e-9 * H.norm());
  EXPECT_LT((at.b - b).norm(), 1e-9 * b.norm());
  EXPECT_NEAR(at.cost, cost, 1e-6 * cost);
  EXPECT_NEAR(at.squared, cost, 1e-6 * cost);  // with a loss so wide nothing is bounded
  // The slope of b is -H where residuals are small.
  const double step = 1e-6;
  for (Eigen::Index i = 0; i < kJoint; ++i) {
    // A shift of the mount moves keyframe and image alike, so that its own rows are no larger than the residuals.
    if (i >= joint_index::mount && i < joint_index::clones) continue;
    const Point next = moved(point_of(corridor), step * VectorXd::Unit(kJoint, i));
    VectorXd off = (at.b - linearized(next, corridor, config).b) / step - at.H.col(i);
    off.segment<mount_index::size>(joint_index::mount).setZero();
    EXPECT_LT(off.norm(), 0.05 * at.H.col(i).norm() + 1e-9) << i;
  }
}

TEST(VisualResiduals, ClaimNoMoreInformationThanTheCap) {
  Random random(33);
  const Corridor corridor = corridor_of(random, {.depth_m = 0.0}, 40, 0);
  const auto with_cap = [&](double cap) {
    return linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera,
                           {.max_information = cap, .common_shift_m = 0.0, .weights = false});
  };
  const JointEquations all = with_cap(0.0), some = with_cap(20.0);
  EXPECT_EQ(all.inliers, some.inliers);
  const double share = 20.0 / all.inliers;
  EXPECT_LT((some.H - share * all.H).norm(), 1e-9 * all.H.norm());
  EXPECT_LT((some.b - share * all.b).norm(), 1e-9 * all.b.norm());
  EXPECT_NEAR(some.cost, share * all.cost, 1e-9 * all.cost);
  EXPECT_NEAR(some.squared / some.expected, all.squared / all.expected, 1e-9);
}

TEST(VisualResiduals, TellAShiftNoBetterThanTheErrorsThatTheyShareHoweverNearTheyAre) {
  Random random(39);
  Corridor corridor = corridor_of(random, {.depth_m = 0.0}, 40, 0);
  const auto with_shift = [&](double common_shift_m) {
    return linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera,
                           {.max_information = 0.0, .common_shift_m = common_shift_m, .weights = false});
  };
  const JointEquations all = with_shift(0.0), some = with_shift(0.05);
  const double shift_information = some.H.block<3, 3>(error_index::p, error_index::p).trace();
  EXPECT_LE(shift_information, 2.0 / (0.05 * 0.05));
  EXPECT_GT(shift_information, 1.5 / (0.05 * 0.05));  // the loss takes a part
  EXPECT_NEAR(some.squared / some.expected, all.squared / all.expected, 1e-9);
  EXPECT_LT((with_shift(1e-9).H - all.H).norm(), 1e-12 * all.H.norm());
}

TEST(VisualResiduals, LeaveThePointsTheirSayBesideLinesThatAreHardlyKnown) {
  Random random(38);
  Corridor corridor = corridor_of(random, {.line_m = 0.3}, 40, 60);
  const auto information = [&] {
    return linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera, {})
        .H.trace();
  };
  const double with_lines = information();
  corridor.seen.lines.clear();
  EXPECT_GT(with_lines, 0.9 * information());
}

TEST(VisualResiduals, GateIsAsWideAsThePredictionIsUnsure) {
  Random random(34);
  Corridor corridor = corridor_of(random, {});
  corridor.now.p_W.x() += 0.5;  // tens of pixels
  const auto inliers = [&](const MatrixXd& search) {
    return linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera, {},
                           search)
        .inliers;
  };
  MatrixXd unsure = MatrixXd::Zero(kJoint, kJoint);
  EXPECT_LT(inliers(unsure), 60);
  unsure(3, 3) = 0.25;
  EXPECT_GT(inliers(unsure), 120);
  // A keyframe that shares the doubt takes it away again.
  const Eigen::Index along[] = {3, joint_index::clone(0) + 3, joint_index::clone(1) + 3, joint_index::clone(2) + 3};
  for (const Eigen::Index i : along)
    for (const Eigen::Index j : along) unsure(i, j) = 0.25;
  corridor.seen.lines.clear();
  EXPECT_LT(inliers(unsure), 60);
}

TEST(VisualResiduals, LeaveOutLinesThatTurnedOrRunThroughTheCamera) {
  Random random(35);
  Corridor corridor = corridor_of(random, {}, 0, 1);
  const auto inliers = [&] {
    return linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera,
                           {.gate = 1e9})
        .inliers;
  };
  EXPECT_EQ(inliers(), 1);
  LineObservation& line = corridor.seen.lines[0];
  const LineObservation straight = line;
  const Vector2d along = line.end_px - line.start_px;
  line.end_px += 0.3 * Vector2d(-along.y(), along.x());  // 17 degrees
  EXPECT_EQ(inliers(), 0);
  line = straight;
  const Vector3d camera_W = (corridor.now.T_W_I() * corridor.rig.T_I_C).translation();
  const Vector3d beside_W = camera_W + Vector3d(0.001, 0.5, 0.0);  // in the plane of the image's axes
  const SE3 T_K_W = (corridor.keyframes[line.keyframe] * corridor.rig.T_I_C).inverse();
  line.line_K = T_K_W * test::landmark_between(beside_W, beside_W + Vector3d(0.0, 0.0, 1.0), 0.01);
  EXPECT_EQ(inliers(), 0);
}

TEST(AdaptiveWeights, FavourPointsOnLinesAndAddNoInformation) {
  std::vector<PointObservation> points(4);
  points[1].line_px = 0.0;
  points[2].line_px = 3.0;
  const auto weights = adaptive_weights(points, {.weight_gain = 1.5, .weight_sigma_px = 1.5});
  EXPECT_NEAR(weights[1] / weights[0], 3.0, 1e-12);
  EXPECT_NEAR(weights[2] / weights[0], 1.5 * (1.0 + std::exp(-4.0)), 1e-12);
  EXPECT_EQ(weights[3], weights[0]);
  double squares = 0.0;
  for (const double weight : weights) squares += weight * weight;
  EXPECT_NEAR(squares, 4.0, 1e-12);
  EXPECT_THAT(adaptive_weights(points, {.weights = false}), testing::Each(1.0));
}

TEST(NearestOfEach, KeepsTheEdgeThatLiesWhereTheLineOfTheMapIsSeen) {
  Random random(37);
  Corridor corridor = corridor_of(random, {.pixel_px = 0.0, .line_m = 0.0}, 0, 3);
  std::vector<LineObservation>& lines = corridor.seen.lines;
  for (std::uint32_t i = 0; i < 3; ++i) lines[i].line_K.id = i;
  const std::vector<LineObservation> right = lines;
  LineObservation parallel = lines[1];  // the other edge of the same post
  parallel.start_px.x() += 6.0;
  parallel.end_px.x() += 6.0;
  lines.insert(lines.begin(), parallel);
  const auto kept =
      nearest_of_each(lines, corridor.now.T_W_I(), corridor.keyframes, corridor.rig.T_I_C, *corridor.rig.camera);
  ASSERT_EQ(kept.size(), 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(kept[i].start_px, right[kept[i].line_K.id].start_px);
}

TEST(KeyframeNoise, IsTheSpreadOfPosesThatNoisyKeyframesShow) {
  Random random(36);
  Corridor corridor = corridor_of(random, {.pixel_px = 0.0, .depth_m = 0.0}, 60, 0);
  corridor.keyframes.resize(1);
  corridor.seen.points.resize(60);
  corridor.now.R_W_I = corridor.keyframes[0].asSO3();
  corridor.now.p_W = corridor.keyframes[0].translation();
  std::vector<Vector3d> points_K;
  for (const PointObservation& point : corridor.seen.points) points_K.push_back(point.p_K_m);
  const Matrix6 claimed = keyframe_noise(points_K, corridor.rig.T_I_C, *corridor.rig.camera, 0.7);

  Matrix6 spread = Matrix6::Zero();
  const int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    for (PointObservation& point : corridor.seen.points)
      point.observed_px = *corridor.rig.camera->project(point.p_K_m) + pixel_noise(random, {.pixel_px = 0.7});
    const JointEquations at =
        linearize_image(corridor.now, corridor.mount(), corridor.keyframes, corridor.seen, *corridor.rig.camera,
                        unbounded({.loss = 1e6, .gate = 1e9, .weights = false}));
    const Vector6 shown = at.H.topLeftCorner<6, 6>().ldlt().solve(at.b.head<6>());
    spread += shown * shown.transpose() / trials;
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(spread(i, i) / claimed(i, i), 1.0, 0.25) << i;
}

/// The filter's update over all states and keyframes, plainly. Returns the joint error from the prior.
struct Update {
  VectorXd moved;
  MatrixXd covariance;
  JointEquations last;
};
Update update(const Point& prior, const MatrixXd& covariance, const Corridor& corridor, const VisualConfig& config) {
  Update result{.moved = VectorXd::Zero(kJoint), .covariance = covariance, .last = JointEquations(3)};
  for (int i = 0; i < 10; ++i) {
    result.last = linearized(moved(prior, result.moved), corridor, config, covariance);
    const Eigen::PartialPivLU<MatrixXd> system(MatrixXd::Identity(kJoint, kJoint) + covariance * result.last.H);
    result.covariance = system.solve(covariance);
    result.moved += system.solve(covariance * result.last.b - result.moved);
  }
  return result;
}

/// What the LiDAR leaves: keyframes that drifted apart a little, and a present pose that slid along the corridor.
struct Prior {
  MatrixXd root = MatrixXd::Zero(kJoint, kJoint);  ///< of the covariance

  explicit Prior(double turn_rad, double shift_m) {
    const auto block = [&](Eigen::Index row, Eigen::Index column) { return root.block<6, 6>(row, column); };
    Vector6 sigmas;
    sigmas << Vector3d::Constant(turn_rad), Vector3d::Constant(shift_m);
    const Matrix6 step = sigmas.asDiagonal();
    for (const std::size_t older : {0, 1, 2}) {
      const Eigen::Index from = joint_index::clone(older);
      block(0, from) = step;
      for (std::size_t k = older; k < 3; ++k) block(joint_index::clone(k), from) = step;
    }
    sigmas[3] = 0.3;
    block(0, 0) = sigmas.asDiagonal();
    root.block<12, 12>(6, 6) = 0.01 * Eigen::Matrix<double, 12, 12>::Identity();
  }
  MatrixXd covariance() const { return root * root.transpose(); }
};

struct Consistency {
  Vector6 normalised = Vector6::Zero();  ///< mean squared error over variance, of theta and p
  double rms_along_m = 0.0;
  Innovation innovation{.misfit = 0.0, .correction = 0.0};  ///< mean ratios
};
struct Setup {
  Prior prior{0.002, 0.01};
  SE3 wrong_extrinsic = SE3::Identity();
  int points_per_keyframe = 40;
  int trials = 30;
};
Consistency simulate(const Noise& noise, const VisualConfig& config, unsigned seed, const Setup& setup = {}) {
  const auto& [prior, wrong_extrinsic, points_per_keyframe, trials] = setup;
  Consistency mean;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(seed + static_cast<unsigned>(trial));
    Corridor corridor = corridor_of(random, noise, points_per_keyframe);
    const VectorXd offset = prior.root * VectorXd::NullaryExpr(kJoint, [&] { return random.normal(); });
    corridor.rig.T_I_C = corridor.rig.T_I_C * wrong_extrinsic;
    const Point before = moved(point_of(corridor), offset);
    const Update result = update(before, prior.covariance(), corridor, config);
    const Vector6 error = boxminus(moved(before, result.moved).now, corridor.now).head<6>();
    mean.normalised += error.cwiseAbs2().cwiseQuotient(result.covariance.diagonal().head<6>()) / trials;
    mean.rms_along_m += error[3] * error[3] / trials;
    const Innovation shown = innovation(result.last, result.moved, prior.covariance());
    mean.innovation.misfit += shown.misfit / trials;
    mean.innovation.correction += shown.correction / trials;
  }
  mean.rms_along_m = std::sqrt(mean.rms_along_m);
  return mean;
}

TEST(VisualUpdate, RecoversTheMotionAlongACorridorAsWellAsItClaims) {
  const Consistency points = simulate({}, unbounded({.weights = false, .lines = false}), 1000);
  const Consistency both = simulate({}, unbounded({.weights = false}), 1000);
  for (const Consistency& mean : {points, both}) {
    for (int i = 0; i < 6; ++i) {
      EXPECT_GT(mean.normalised[i], 0.3) << i;
      EXPECT_LT(mean.normalised[i], 3.0) << i;
    }
    EXPECT_NEAR(mean.innovation.misfit, 1.0, 0.15);
    EXPECT_NEAR(mean.innovation.correction, 1.0, 0.4);
    RecordProperty("rms_along_mm", std::to_string(1000.0 * mean.rms_along_m));
  }
  // From 0.3 m; the keyframes themselves are 0.01 to 0.03 m off, which points and lines share.
  EXPECT_LT(points.rms_along_m, 0.03);
  EXPECT_LT(both.rms_along_m, 0.03);
}

TEST(VisualUpdate, SeesNoMisfitInGoodImagesHoweverLittleTheyMaySay) {
  for (const double most : {4.0, 10.0, 40.0}) {
    const Consistency mean =
        simulate({}, {.max_information = most, .common_shift_m = 0.0, .weights = false, .lines = false}, 3000);
    EXPECT_NEAR(mean.innovation.misfit, 1.0, 0.2) << most;
    EXPECT_NEAR(mean.innovation.correction, 1.0, 0.4) << most;
  }
}

TEST(VisualUpdate, HoldsByLinesWhereThereAreFewPoints) {
  const auto along_m = [](bool lines) {
    return simulate({}, unbounded({.weights = false, .lines = lines}), 1000, {.points_per_keyframe = 2, .trials = 200})
        .rms_along_m;
  };
  const double with_m = along_m(true), without_m = along_m(false);
  RecordProperty("ratio", std::to_string(with_m / without_m));
  EXPECT_LT(with_m, 0.85 * without_m);
}

TEST(VisualUpdate, SurvivesThirtyPercentOfGrossOutliers) {
  const Consistency mean = simulate({.false_share = 0.3}, unbounded({.weights = false}), 2000);
  for (int i = 0; i < 6; ++i) {
    EXPECT_GT(mean.normalised[i], 0.3) << i;
    EXPECT_LT(mean.normalised[i], 3.0) << i;
  }
  EXPECT_LT(mean.rms_along_m, 0.03);
}

TEST(VisualUpdate, ShowsABadImageInTheMisfit) {
  const VisualConfig config = unbounded({.weights = false});
  EXPECT_GT(simulate({.pixel_px = 2.5}, config, 4000).innovation.misfit, 1.5);
}

TEST(VisualUpdate, ShowsAWrongExtrinsicInTheInnovations) {
  const SE3 wrong = pose_from(exp_so3(Vector3d(0.0, 0.5 * M_PI / 180.0, 0.0)), Vector3d::Zero());
  const VisualConfig config = unbounded({.weights = false});
  // A scan leaves but millimetres between the keyframes, except along the corridor.
  const Prior prior(0.0005, 0.002);
  const Innovation right = simulate({}, config, 3000, {.prior = prior}).innovation;
  EXPECT_NEAR(right.correction, 1.0, 0.4);
  EXPECT_GT(simulate({}, config, 3000, {prior, wrong}).innovation.correction, 1.7 * right.correction);
}

}  // namespace
}  // namespace pllit
