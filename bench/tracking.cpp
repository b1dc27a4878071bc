// How many of a keyframe's points are found again, and rightly, 5, 10 and 20 images of 10 Hz later, in simulated drives
// and walks whose truth is exact: bench_tracking [--keep FOLDER] [--seeds FIRST COUNT]. A point counts where it shows
// in the later image; it is found rightly within 2 px of where it shows. FOLDER keeps rendered images for the next run.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <format>
#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <random>

#include "pllit/sim/camera/agc.hpp"
#include "pllit/thermal/classical_extractor.hpp"
#include "pllit/thermal/keyframe_window.hpp"
#include "pllit/thermal/matching.hpp"
#include "simulated_views.hpp"

namespace {

using namespace pllit;
using bench::SimulatedViews;
using bench::View;
using Eigen::Vector2f;

constexpr std::array kGaps{5, 10, 20};
constexpr int kImages = 21, kPoints = 400;
constexpr int kFreezeFrom = 1, kFreezeTo = 5;  // images that repeat the one before, of shutter events
constexpr int kLevels = 1 << 14;

enum class Video { steady, jumps, shutter };
constexpr std::array kVideoNames{"gain control", "gain jumps", "shutter event"};

/// 8-bit video of a window of views.
std::vector<cv::Mat> video_of(const std::vector<View>& views, Video kind, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> gain(0.6, 1.6), bias(-40.0, 40.0);
  const AgcConfig agc;
  GreyMapping mapping;
  std::vector<cv::Mat> video;
  double a = 1.0, b = 0.0;
  for (int i = 0; i < static_cast<int>(views.size()); ++i) {
    const cv::Mat& counts = views[static_cast<std::size_t>(i)].counts;
    if (kind == Video::shutter && i >= kFreezeFrom && i < kFreezeTo) {
      video.push_back(video.back().clone());
      continue;
    }
    if (kind == Video::shutter && i == kFreezeTo) mapping.clear();
    mapping = smoothed(mapping, grey_mapping(counts, agc, kLevels), mapping.empty() ? 256 : agc.speed_256);
    if ((kind == Video::jumps && i > 0 && i % 4 == 0) || (kind == Video::shutter && i == kFreezeTo)) {
      a = gain(engine);
      b = bias(engine);
    }
    GreyMapping changed = mapping;
    for (float& grey : changed)
      grey = std::clamp(static_cast<float>(a * (static_cast<double>(grey) - 127.5) + 127.5 + b), 0.0F, 255.0F);
    video.push_back(applied(changed, counts));
  }
  return video;
}

struct Count {
  double there = 0.0, reported = 0.0, right = 0.0;
  void operator+=(const Count& other) {
    there += other.there;
    reported += other.reported;
    right += other.right;
  }
};

/// Where a method found each of a keyframe's points; nothing where it did not.
using Found = std::vector<std::optional<Vector2f>>;

Count judged(const std::vector<std::optional<Vector3d>>& surfaces_W, const Found& found, const View& view,
             SimulatedViews& world) {
  Count count;
  for (std::size_t i = 0; i < surfaces_W.size(); ++i) {
    if (!surfaces_W[i]) continue;
    const auto truth = world.pixel_of(*surfaces_W[i], view);
    count.there += truth.has_value();
    if (!found[i]) continue;
    count.reported += 1.0;
    count.right += truth && (*truth - *found[i]).norm() <= 2.0F;
  }
  return count;
}

std::vector<std::optional<Vector3d>> surfaces_of(const std::vector<Vector2f>& points, const View& view,
                                                 SimulatedViews& world) {
  std::vector<std::optional<Vector3d>> surfaces_W;
  for (const Vector2f& point : points) surfaces_W.push_back(world.surface_W(view, point));
  return surfaces_W;
}

using Scores = std::map<std::pair<std::string, int>, Count>;  // method, gap

/// The pose as LiDAR and IMU might predict it.
SE3 predicted(const SE3& T_W_C, std::mt19937& engine) {
  std::normal_distribution<double> gaussian(0.0, 1.0);
  const auto vector = [&](double sigma) {
    return Vector3d(sigma * Vector3d(gaussian(engine), gaussian(engine), gaussian(engine)));
  };
  return T_W_C * pose_from(exp_so3(vector(0.001)), vector(0.005));
}

/// Three points in four have a depth, to 2 cm and 1 %.
void give_depths(Keyframe& keyframe, const std::vector<std::optional<Vector3d>>& surfaces_W, std::mt19937& engine) {
  std::normal_distribution<double> gaussian(0.0, 1.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const auto& surface_W : surfaces_W) {
    keyframe.depths.emplace_back();
    if (!surface_W || share(engine) > 0.75) continue;
    const double range_m = (*surface_W - keyframe.T_W_C.translation()).norm(), sigma_m = 0.02 + 0.01 * range_m;
    keyframe.depths.back() = FeatureDepth{.range_m = range_m + sigma_m * gaussian(engine), .sigma_m = sigma_m};
  }
}

/// Describes the extractor's points anew.
using Describe = std::function<cv::Mat(const cv::Mat&, std::vector<Vector2f>&)>;

struct Matcher {
  std::string name;
  Describe describe;  ///< none: the extractor's own descriptors
  MatchConfig config;
  ClassicalConfig extraction{};
};

struct Timing {
  double seconds = 0.0;
  int calls = 0;
};

void run_matcher(const Matcher& matcher, const std::vector<View>& views, const std::vector<cv::Mat>& video,
                 SimulatedViews& world, Scores& scores, Timing& timing) {
  ClassicalExtractor extractor(matcher.extraction);
  const auto extracted = [&](const cv::Mat& image) {
    Features features = *extractor.extract(image);
    if (matcher.describe) features.descriptors = matcher.describe(image, features.points_px);
    return features;
  };
  std::mt19937 engine(7);
  Arena arena(1);
  Keyframe keyframe{.id = 0,
                    .time = views[0].time,
                    .T_W_C = views[0].T_W_C,
                    .features = strongest(extracted(video[0]), kPoints),
                    .image = image_for_alignment(video[0])};
  const auto surfaces_W = surfaces_of(keyframe.features.points_px, views[0], world);
  give_depths(keyframe, surfaces_W, engine);
  for (const int gap : kGaps) {
    const auto k = static_cast<std::size_t>(gap);
    const SE3 T_W_C = predicted(views[k].T_W_C, engine);
    const cv::Mat image = image_for_alignment(video[k]);
    Found found(surfaces_W.size());
    {
      const Features now = extracted(video[k]);
      const auto begin = std::clock();
      const Tracks tracks =
          match_to_keyframes(now, image, T_W_C, {&keyframe, 1}, world.camera(), matcher.config, arena);
      timing.seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      ++timing.calls;
      for (const PointMatch& match : tracks.points)
        found[static_cast<std::size_t>(match.reference)] = now.points_px[static_cast<std::size_t>(match.current)];
      for (const PointTrack& track : tracks.tracked) found[static_cast<std::size_t>(track.reference)] = track.at_px;
    }
    scores[{matcher.name, gap}] += judged(surfaces_W, found, views[k], world);
  }
}

struct KltConfig {
  double clip = 2.0;
  int window = 13, levels = 4;
  double back_px = 0.5, quality = 0.005, distance_px = 8.0;
};

std::vector<cv::Point2f> cv_points(const std::vector<Vector2f>& points) {
  std::vector<cv::Point2f> out;
  for (const Vector2f& p : points) out.emplace_back(p.x(), p.y());
  return out;
}

/// Good features to track (Shi-Tomasi) of the equalised image, followed from image to image forwards and backwards.
/// Repeated images are noticed and left out.
void run_klt(const std::string& name, const KltConfig& config, const std::vector<View>& views,
             const std::vector<cv::Mat>& video, SimulatedViews& world, Scores& scores) {
  const auto clahe = cv::createCLAHE(config.clip, {8, 8});
  const auto equalised = [&](const cv::Mat& image) {
    cv::Mat out;
    clahe->apply(image, out);
    return out;
  };
  cv::Mat last = equalised(video[0]);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(last, corners, kPoints, config.quality, config.distance_px, {}, 5);
  std::vector<Vector2f> points;
  for (const cv::Point2f& p : corners) points.emplace_back(p.x, p.y);
  const auto surfaces_W = surfaces_of(points, views[0], world);
  Found found(points.begin(), points.end());
  const cv::Size window(config.window, config.window);
  for (int k = 1; k < kImages; ++k) {
    const auto index = static_cast<std::size_t>(k);
    const bool any = std::ranges::any_of(found, [](const auto& one) { return one.has_value(); });
    if (any && cv::countNonZero(video[index] != video[index - 1]) > 0) {
      const cv::Mat now = equalised(video[index]);
      std::vector<std::size_t> alive;
      std::vector<Vector2f> from_points;
      for (std::size_t i = 0; i < found.size(); ++i)
        if (found[i]) {
          alive.push_back(i);
          from_points.push_back(*found[i]);
        }
      const std::vector<cv::Point2f> from = cv_points(from_points);
      std::vector<cv::Point2f> to, back;
      std::vector<std::uint8_t> forth_ok, back_ok;
      std::vector<float> errors;
      cv::calcOpticalFlowPyrLK(last, now, from, to, forth_ok, errors, window, config.levels);
      back = from;
      cv::calcOpticalFlowPyrLK(now, last, to, back, back_ok, errors, window, config.levels,
                               {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01},
                               cv::OPTFLOW_USE_INITIAL_FLOW);
      for (std::size_t i = 0; i < alive.size(); ++i) {
        const bool inside = to[i].x > 1 && to[i].y > 1 && to[i].x < static_cast<float>(now.cols) - 2 &&
                            to[i].y < static_cast<float>(now.rows) - 2;
        const bool good = forth_ok[i] && back_ok[i] && inside && cv::norm(back[i] - from[i]) < config.back_px;
        found[alive[i]] = good ? std::optional(Vector2f(to[i].x, to[i].y)) : std::nullopt;
      }
      last = now;
    }
    if (std::ranges::count(kGaps, k) > 0) scores[{name, k}] += judged(surfaces_W, found, views[index], world);
  }
}

std::vector<cv::KeyPoint> keypoints(const std::vector<Vector2f>& points, float size) {
  std::vector<cv::KeyPoint> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    out.emplace_back(cv::Point2f(points[i].x(), points[i].y()), size, 0.0F, 0.0F, 0, static_cast<int>(i));
  return out;
}

/// OpenCV may drop points at the border: those left stand in `points`, and rows get unit length.
cv::Mat sift(const cv::Mat& image, std::vector<Vector2f>& points) {
  auto marked = keypoints(points, 8.0F);
  cv::Mat rows;
  cv::SIFT::create()->compute(image, marked, rows);
  std::vector<Vector2f> left;
  for (const cv::KeyPoint& point : marked) left.push_back(points[static_cast<std::size_t>(point.class_id)]);
  points = left;
  for (int i = 0; i < rows.rows; ++i) rows.row(i) /= std::max(cv::norm(rows.row(i)), 1e-9);
  return rows;
}

/// Bits become +-1/16: the squared distance is the Hamming distance / 64.
cv::Mat orb(const cv::Mat& image, std::vector<Vector2f>& points) {
  auto marked = keypoints(points, 31.0F);
  cv::Mat bits;
  cv::ORB::create(500, 1.2F, 1)->compute(image, marked, bits);
  std::vector<Vector2f> left;
  for (const cv::KeyPoint& point : marked) left.push_back(points[static_cast<std::size_t>(point.class_id)]);
  points = left;
  cv::Mat rows(bits.rows, 256, CV_32FC1);
  for (int i = 0; i < rows.rows; ++i)
    for (int bit = 0; bit < 256; ++bit)
      rows.at<float>(i, bit) = (bits.at<std::uint8_t>(i, bit / 8) >> (bit % 8)) & 1 ? 1.0F / 16 : -1.0F / 16;
  return rows;
}

void report(const std::string& title, const Scores& scores) {
  std::printf("%s\n%-34s", title.c_str(), "");
  for (const int gap : kGaps) std::printf(" | %2d: found  right  count", gap);
  std::puts("");
  std::string last;
  for (const auto& [key, unused] : scores) {
    if (key.first == last) continue;
    last = key.first;
    std::printf("%-34s", last.c_str());
    for (const int gap : kGaps) {
      const Count& c = scores.at({last, gap});
      std::printf(" |   %5.3f  %5.3f  %5.0f", c.right / std::max(c.there, 1.0), c.right / std::max(c.reported, 1.0),
                  c.right);
    }
    std::puts("");
  }
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  int first = 500, count = 2;
  bool tune = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--keep" && i + 1 < argc) folder = argv[++i];
    if (word == "--tune") tune = true;
    if (word == "--seeds" && i + 2 < argc) {
      first = std::atoi(argv[++i]);
      count = std::atoi(argv[++i]);
    }
  }
  std::vector<Matcher> matchers{{"classical", {}, {}}};
  MatchConfig loose;
  loose.most_distance = 1.2;
  matchers.push_back({"our points, ORB", orb, loose});
  matchers.push_back({"our points, SIFT upright", sift, loose});
  if (tune) {
    const auto variant = [&](const char* name, const AlignConfig& align) {
      Matcher matcher{name, {}, {}};
      matcher.config.align = align;
      matchers.push_back(matcher);
    };
    variant("not aligned", {.enabled = false});
    variant("half 4", {.half_px = 4});
    variant("half 5", {.half_px = 5});
    variant("gate 5", {.gate_px = 5.0});
    variant("correlation 0.7", {.least_correlation = 0.7});
    variant("correlation 0.9", {.least_correlation = 0.9});
    variant("sigma 1", {.most_sigma_px = 1.0});
    variant("sigma 0.3", {.most_sigma_px = 0.3});
  }
  // Tuned over contrast limit, window, levels and the backward check's limit on seed 901: a small window is best under
  // steady gain control, a large one where it jumps.
  std::vector<std::pair<std::string, KltConfig>> klts{{"GFTT + CLAHE + KLT, 15 px", {.window = 15, .back_px = 0.5}},
                                                      {"GFTT + CLAHE + KLT, 31 px", {.window = 31, .back_px = 1.5}}};
  std::map<Video, Scores> drives, walks;
  Timing timing;
  for (int seed = first; seed < first + count; ++seed)
    for (const char* scene : {"street?length=200", "room?duration=40", "plant?duration=40"}) {
      const bool drive = std::string(scene).starts_with("street");
      auto world = SimulatedViews::make(std::format("sim:{}&seed={}", scene, seed));
      if (!world) {
        std::fprintf(stderr, "%s\n", world.error().message.c_str());
        return 1;
      }
      for (const double begin_s : {6.0, 11.0}) {
        const std::vector<View> views = world->views(begin_s, kImages, folder);
        for (const Video kind : {Video::steady, Video::jumps, Video::shutter}) {
          const std::vector<cv::Mat> video = video_of(views, kind, static_cast<unsigned>(seed));
          Scores& scores = drive ? drives[kind] : walks[kind];
          for (const Matcher& matcher : matchers) run_matcher(matcher, views, video, *world, scores, timing);
          for (const auto& [name, config] : klts) run_klt(name, config, views, video, *world, scores);
        }
      }
    }
  for (const Video kind : {Video::steady, Video::jumps, Video::shutter}) {
    report(std::format("drives, {}", kVideoNames[static_cast<std::size_t>(kind)]), drives[kind]);
    report(std::format("walks, {}", kVideoNames[static_cast<std::size_t>(kind)]), walks[kind]);
  }
  std::printf("matching with one keyframe: %.2f ms of processor time\n",
              1e3 * timing.seconds / std::max(timing.calls, 1));
  return 0;
}
