#include "pllit/thermal/matching.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "pllit/thermal/prediction.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;

Camera camera() { return {.width = 640, .height = 512, .fx = 770, .fy = 770, .cx = 319.5, .cy = 255.5}; }

/// A keyframe at the origin and the image now, of the same points.
struct Views {
  Keyframe keyframe;
  Features now;
  SE3 T_W_C_now;
  std::vector<int> truth;  ///< of each point of the keyframe its index now; negative where it is not seen
};

struct Setting {
  int points = 300;
  double known_depths = 1.0;  ///< share
  double noise_px = 0.5;
  double descriptor_noise = 0.3;  ///< length of the vector added to unit descriptors
  int strangers = 100;            ///< points that only the image now has
};

void append_row(cv::Mat& rows, std::mt19937& engine, const Eigen::VectorXf& base, double noise) {
  std::normal_distribution<float> gaussian(0.0F, 1.0F);
  Eigen::VectorXf row = base;
  for (float& value : row)
    value += static_cast<float>(noise) * gaussian(engine) / std::sqrt(static_cast<float>(row.size()));
  row.normalize();
  rows.push_back(cv::Mat(1, static_cast<int>(row.size()), CV_32FC1, row.data()).clone());
}

Views views(const Setting& setting, const SE3& T_W_C_now, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> u(10.0, 629.0), v(10.0, 501.0), range(3.0, 25.0), share(0.0, 1.0);
  std::normal_distribution<double> gaussian(0.0, 1.0);
  const Camera cam = camera();
  Views views{.keyframe = {}, .now = {}, .T_W_C_now = T_W_C_now, .truth = {}};
  for (int i = 0; i < setting.points; ++i) {
    const Eigen::Vector2d pixel(u(engine), v(engine));
    const double range_m = range(engine);
    Eigen::VectorXf descriptor(64);
    for (float& value : descriptor) value = static_cast<float>(gaussian(engine));
    descriptor.normalize();
    views.keyframe.features.points_px.push_back(pixel.cast<float>());
    views.keyframe.depths.push_back(share(engine) < setting.known_depths
                                        ? std::optional(FeatureDepth{.range_m = range_m, .sigma_m = 0.02})
                                        : std::nullopt);
    append_row(views.keyframe.features.descriptors, engine, descriptor, setting.descriptor_noise);
    const auto seen = cam.project(T_W_C_now.inverse().act(Vector3d(range_m * cam.ray(pixel))));
    const bool inside = seen && seen->x() > 5 && seen->y() > 5 && seen->x() < 634 && seen->y() < 506;
    views.truth.push_back(inside ? static_cast<int>(views.now.points_px.size()) : -1);
    if (!inside) continue;
    views.now.points_px.push_back(
        (*seen + setting.noise_px * Eigen::Vector2d(gaussian(engine), gaussian(engine))).cast<float>());
    append_row(views.now.descriptors, engine, descriptor, setting.descriptor_noise);
  }
  for (int i = 0; i < setting.strangers; ++i) {
    Eigen::VectorXf descriptor(64);
    for (float& value : descriptor) value = static_cast<float>(gaussian(engine));
    views.now.points_px.push_back(Vector2f(static_cast<float>(u(engine)), static_cast<float>(v(engine))));
    append_row(views.now.descriptors, engine, descriptor.normalized(), 0.0);
  }
  return views;
}

SE3 moved(const Vector3d& position, const Vector3d& turned_rad) { return pose_from(exp_so3(turned_rad), position); }

const SE3 ahead = moved({0.2, 0.1, 0.8}, {0.02, -0.05, 0.03});

Tracks matched(const Views& views, const SE3& predicted, const MatchConfig& config = {}) {
  Arena arena(2);
  return match_to_keyframes(views.now, {}, predicted, {&views.keyframe, 1}, camera(), config, arena);
}

struct Score {
  double found = 0.0, right = 0.0;  ///< shares: of the points that are there, of the matches
};

Score score(const Tracks& tracks, const Views& views) {
  double right = 0.0, there = 0.0;
  for (const PointMatch& match : tracks.points)
    right += views.truth[static_cast<std::size_t>(match.reference)] == match.current;
  for (const int index : views.truth) there += index >= 0;
  return {right / there, right / static_cast<double>(tracks.points.size())};
}

TEST(Matching, FindsPointsOfKnownDepthWhereThePosePutsThem) {
  const Views seen = views({}, ahead, 1);
  const Score s = score(matched(seen, ahead), seen);
  EXPECT_GT(s.found, 0.97);
  EXPECT_GT(s.right, 0.99);
}

TEST(Matching, FindsPointsWithoutDepthAlongTheirEpipolarLines) {
  const Views seen = views({.known_depths = 0.0}, ahead, 2);
  const Score s = score(matched(seen, ahead), seen);
  EXPECT_GT(s.found, 0.9);
  EXPECT_GT(s.right, 0.99);
}

TEST(Matching, CorrectsAPredictionThatIsOffAsAWhole) {
  // 0.9 degrees: 12 pixels everywhere.
  const Views seen = views({.known_depths = 0.7}, ahead, 3);
  const SE3 off = ahead * moved(Vector3d::Zero(), {0.0, 0.0157, 0.0});
  const Score s = score(matched(seen, off), seen);
  EXPECT_GT(s.found, 0.93);
  EXPECT_GT(s.right, 0.99);
}

TEST(Matching, RefusesPointsThatLookRightInTheWrongPlace) {
  Views seen = views({.descriptor_noise = 0.0, .strangers = 0}, SE3::Identity(), 4);
  // A third of the points stand elsewhere, 8 to 12 pixels off, within the window but off what the others say.
  for (std::size_t i = 0; i < seen.now.points_px.size(); i += 3) seen.now.points_px[i] += Vector2f(9.0F, 0.0F);
  const Tracks tracks = matched(seen, SE3::Identity());
  for (const PointMatch& match : tracks.points) EXPECT_NE(match.current % 3, 0);
  EXPECT_GT(tracks.points.size(), seen.now.points_px.size() / 2);
}

TEST(Matching, RefusesWhatIsNotClearlyTheBest) {
  Views seen = views({.strangers = 0}, SE3::Identity(), 5);
  // Every point has a twin 8 pixels away that looks the same.
  const std::size_t count = seen.now.points_px.size();
  for (std::size_t i = 0; i < count; ++i) {
    seen.now.points_px.push_back(seen.now.points_px[i] + Vector2f(8.0F, 0.0F));
    seen.now.descriptors.push_back(seen.now.descriptors.row(static_cast<int>(i)).clone());
  }
  EXPECT_TRUE(matched(seen, SE3::Identity(), {.gate_px = 16.0}).points.empty());
  EXPECT_GT(matched(seen, SE3::Identity(), {.gate_px = 4.0}).points.size(), count / 2) << "the pose tells them apart";
}

TEST(Matching, GivesEachPointAtMostOnePartnerAKeyframe) {
  const Views seen = views({.points = 600, .descriptor_noise = 0.7}, ahead, 6);
  std::set<int> references, currents;
  const Tracks tracks = matched(seen, ahead);
  EXPECT_GT(tracks.points.size(), 100U);
  for (const PointMatch& match : tracks.points) {
    EXPECT_TRUE(references.insert(match.reference).second);
    EXPECT_TRUE(currents.insert(match.current).second);
  }
}

TEST(Matching, FindsWhatASearchOverAllPairsFinds) {
  const Views seen = views({.descriptor_noise = 0.6}, SE3::Identity(), 7);
  const MatchConfig config{.window_px = 20.0, .gate_px = 20.0};
  const Tracks tracks = matched(seen, SE3::Identity(), config);
  const cv::Mat similarity = seen.keyframe.features.descriptors * seen.now.descriptors.t();
  std::set<std::pair<int, int>> naive, fast;
  const auto best_of = [&](int i) {
    std::vector<std::pair<float, int>> near;
    for (int k = 0; k < similarity.cols; ++k)
      if ((seen.now.points_px[static_cast<std::size_t>(k)] -
           seen.keyframe.features.points_px[static_cast<std::size_t>(i)])
              .norm() < 19.5F)  // the pose that matches agree on moves the window's rim a little
        near.push_back({similarity.at<float>(i, k), k});
    std::ranges::sort(near, std::ranges::greater{});
    return near;
  };
  for (int i = 0; i < similarity.rows; ++i) {
    const auto near = best_of(i);
    const float distance = near.empty() ? 9.0F : std::sqrt(2.0F - 2.0F * near[0].first);
    const auto second = std::ranges::find_if(near, [&](const auto& other) {
      return (seen.now.points_px[static_cast<std::size_t>(other.second)] -
              seen.now.points_px[static_cast<std::size_t>(near[0].second)])
                 .norm() > 6.0F;
    });
    if (distance > 1.0F || (second != near.end() && distance > 0.9F * std::sqrt(2.0F - 2.0F * second->first))) continue;
    naive.insert({i, near[0].second});
  }
  for (const PointMatch& match : tracks.points) fast.insert({match.reference, match.current});
  int both = 0;
  for (const auto& pair : naive) both += fast.contains(pair);
  EXPECT_GE(both, 0.97 * static_cast<double>(std::max(naive.size(), fast.size())));
}

TEST(Matching, FindsThePoseThatMostMatchesAgreeOn) {
  const Views seen = views({.points = 150}, ahead, 11);
  std::vector<PointMatch> matches;
  for (int i = 0; i < 150; ++i)
    if (const int k = seen.truth[static_cast<std::size_t>(i)]; k >= 0)
      matches.push_back({.reference = i, .current = i % 4 == 0 ? (k + 7) % 100 : k});  // a quarter is wrong
  const SE3 truth = ahead.inverse(), off = truth * moved({0.03, -0.02, 0.04}, {0.006, -0.008, 0.01});
  const SE3 agreed = agreed_pose(seen.keyframe, rays_of(seen.keyframe, camera()), matches, seen.now, off, camera());
  EXPECT_LT(log_so3((agreed * truth.inverse()).asSO3()).norm(), 0.001);
  EXPECT_LT((agreed * truth.inverse()).translation().norm(), 0.01);
  matches.resize(9);
  EXPECT_EQ(agreed_pose(seen.keyframe, rays_of(seen.keyframe, camera()), matches, seen.now, off, camera()).coeffs(),
            off.coeffs())
      << "too few tell nothing";
}

TEST(Matching, OfNothingIsNothing) {
  Arena arena(2);
  const Views seen = views({}, ahead, 8);
  EXPECT_TRUE(match_to_keyframes({}, {}, ahead, {&seen.keyframe, 1}, camera(), {}, arena).points.empty());
  EXPECT_TRUE(match_to_keyframes(seen.now, {}, ahead, {}, camera(), {}, arena).points.empty());
  const Keyframe empty;
  EXPECT_TRUE(match_to_keyframes(seen.now, {}, ahead, {&empty, 1}, camera(), {}, arena).points.empty());
  // Looking the other way nothing is in view.
  EXPECT_TRUE(matched(seen, moved(Vector3d::Zero(), {0.0, 3.1, 0.0})).points.empty());
}

/// Three horizontal lines on a wall 5 m away with a few points on each, seen again from 0.3 m to the right.
Views views_of_lines() {
  Views views{.keyframe = {}, .now = {}, .T_W_C_now = moved({0.3, 0.0, 0.0}, Vector3d::Zero()), .truth = {}};
  const float shift = 770.0F * 0.3F / 5.0F;
  std::mt19937 engine(9);
  for (int line = 0; line < 3; ++line) {
    const float y = 100.0F + 120.0F * static_cast<float>(line);
    views.keyframe.features.lines.push_back({.start_px = {150.0F, y}, .end_px = {450.0F, y}, .score = 1.0F});
    views.now.lines.insert(
        views.now.lines.begin(),
        {.start_px = {430.0F - shift, y + 1.0F}, .end_px = {170.0F - shift, y + 1.0F}, .score = 1.0F});
    for (int i = 0; i < 4; ++i) {
      const Vector2f at(180.0F + 60.0F * static_cast<float>(i), y + 0.5F * static_cast<float>(i % 2));
      Eigen::VectorXf descriptor = Eigen::VectorXf::Zero(64);
      descriptor[4 * line + i] = 1.0F;
      views.keyframe.features.points_px.push_back(at);
      const Vector3d ray = camera().ray(at.cast<double>());
      views.keyframe.depths.push_back(FeatureDepth{.range_m = 5.0 / ray.z(), .sigma_m = 0.02});
      append_row(views.keyframe.features.descriptors, engine, descriptor, 0.0);
      views.now.points_px.push_back(at - Vector2f(shift, 0.0F));
      append_row(views.now.descriptors, engine, descriptor, 0.0);
    }
  }
  return views;
}

TEST(LineMatching, GoesByThePointsThatBothLinesShare) {
  const Views seen = views_of_lines();
  const Tracks tracks = matched(seen, seen.T_W_C_now);
  ASSERT_EQ(tracks.points.size(), 12U);
  ASSERT_EQ(tracks.lines.size(), 3U);
  for (const LineMatch& match : tracks.lines) {
    EXPECT_EQ(match.reference + match.current, 2);
    EXPECT_EQ(match.shared_points, 4);
  }
}

TEST(LineMatching, KeepsHowFarAnchoredPointsAreFromTheirLine) {
  Views seen = views_of_lines();
  seen.now.points_px[0].y() -= 6.0F;  // off its line, and off the prediction by less than the gate allows
  const Tracks tracks = matched(seen, seen.T_W_C_now, {.gate_px = 8.0});
  ASSERT_EQ(tracks.points.size(), 12U);
  for (const PointMatch& match : tracks.points) {
    if (match.current == 0) {
      EXPECT_LT(match.line_px, 0.0);
    } else {
      EXPECT_NEAR(match.line_px, match.current % 2 == 0 ? 1.0 : 0.5, 1e-3);
    }
  }
}

TEST(LineMatching, GoesByPlaceWherePointsAreTooFew) {
  Views seen = views_of_lines();
  // One matched point on each line is left; the depth of the others is still known.
  for (std::size_t i = 0; i < 12; ++i)
    if (i % 4 != 0) seen.now.points_px[i].y() += 50.0F;
  const Tracks tracks = matched(seen, seen.T_W_C_now);
  ASSERT_EQ(tracks.lines.size(), 3U);
  for (const LineMatch& match : tracks.lines) {
    EXPECT_EQ(match.reference + match.current, 2);
    EXPECT_EQ(match.shared_points, 1);
  }
}

TEST(LineMatching, RefusesALineThatCrossesThePredictedOne) {
  Views seen = views_of_lines();
  for (LineSegment& line : seen.now.lines) line.end_px.y() += 120.0F;
  for (const LineMatch& match : matched(seen, seen.T_W_C_now).lines) EXPECT_GE(match.shared_points, 2);
  EXPECT_TRUE(matched(seen, seen.T_W_C_now).lines.empty());
}

}  // namespace
}  // namespace pllit
