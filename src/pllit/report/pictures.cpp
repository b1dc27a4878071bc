#include "pllit/report/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace pllit {
namespace {

/// The frame of a plan: metres to pixels.
struct Plan {
  Eigen::AlignedBox2d box_W;
  double px_per_m = 1.0;

  cv::Size size() const {
    const Eigen::Vector2d sides = px_per_m * box_W.sizes();
    return {std::max(1, static_cast<int>(sides.x())), std::max(1, static_cast<int>(sides.y()))};
  }
  cv::Point at(const Eigen::Vector2d& p_W) const {
    const Eigen::Vector2d p = px_per_m * (p_W - box_W.min());
    return {static_cast<int>(p.x()), size().height - 1 - static_cast<int>(p.y())};
  }
};

/// What a reader wants to see: all of the way, and of the points all but a few stray ones.
Plan plan_for(const PointTable& map, const Trajectory& trajectory, const PlanConfig& config) {
  Plan plan;
  for (const StampedPose& pose : trajectory) plan.box_W.extend(pose.T_W_I.translation().head<2>());
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<float> values;
    for (const auto& p_W : map.points) values.push_back(p_W[axis]);
    std::ranges::sort(values);
    const auto share = [&](double s) {
      return static_cast<double>(values[static_cast<std::size_t>(s * double(values.size() - 1))]);
    };
    Eigen::Vector2d low = plan.box_W.min(), high = plan.box_W.max();
    if (plan.box_W.isEmpty()) low = high = map.points.front().head<2>().cast<double>();
    low[axis] = std::min(low[axis], share(0.002));
    high[axis] = std::max(high[axis], share(0.998));
    plan.box_W = Eigen::AlignedBox2d(low, high);
  }
  plan.box_W =
      Eigen::AlignedBox2d(plan.box_W.min().array() - config.margin_m, plan.box_W.max().array() + config.margin_m);
  const double longest_m = plan.box_W.sizes().maxCoeff();
  plan.px_per_m = std::min(config.width_px / longest_m, 1.0 / config.least_cell_m);
  return plan;
}

/// Twice as large or more, where a small place makes a small picture.
cv::Mat enlarged(const cv::Mat& small, int width_px) {
  const int zoom = std::max(1, width_px / (2 * std::max(small.cols, small.rows)) + 1);
  cv::Mat large;
  cv::resize(small, large, {}, zoom, zoom, cv::INTER_NEAREST);
  return large;
}

/// Mean of the intensities that fall into each pixel, 0 to 255; and where there are any.
std::pair<cv::Mat, cv::Mat> levels(const PointTable& map, const std::vector<float>& intensity, const Plan& plan) {
  cv::Mat sum = cv::Mat::zeros(plan.size(), CV_32FC1), count = cv::Mat::zeros(plan.size(), CV_32FC1);
  const Stretch stretch(intensity);
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const cv::Point p = plan.at(map.points[i].head<2>().cast<double>());
    if (p.x < 0 || p.y < 0 || p.x >= sum.cols || p.y >= sum.rows) continue;
    sum.at<float>(p) += stretch(intensity[i]);
    count.at<float>(p) += 1.0F;
  }
  cv::Mat mean, level;
  cv::divide(sum, cv::max(count, 1.0), mean);
  mean.convertTo(level, CV_8U);
  return {level, count > 0.0};
}

void draw_bar(cv::Mat& picture, double px_per_m) {
  double metres = 1.0;
  while (metres * px_per_m < 0.1 * picture.cols)
    metres *= metres == 2.0 || metres == 20.0 || metres == 200.0 ? 2.5 : 2.0;
  const cv::Point from(12, picture.rows - 12), to(12 + static_cast<int>(metres * px_per_m), picture.rows - 12);
  cv::line(picture, from, to, cv::Scalar::all(255), 2);
  cv::putText(picture, std::to_string(static_cast<int>(metres)) + " m", from - cv::Point(0, 8),
              cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(255), 1, cv::LINE_AA);
}

void draw_alarms(cv::Mat& picture, const Plan& plan, std::span<const Anomaly> alarms) {
  const cv::Scalar kMark(255, 255, 255), kEdge(0, 0, 255);
  for (const Anomaly& alarm : alarms) {
    const cv::Point at = plan.at(alarm.position_W.head<2>());
    cv::circle(picture, at, 12, kEdge, 3, cv::LINE_AA);
    cv::circle(picture, at, 14, kMark, 1, cv::LINE_AA);
    cv::putText(picture, std::to_string(alarm.id), at + cv::Point(16, 6), cv::FONT_HERSHEY_SIMPLEX, 0.7, kMark, 2,
                cv::LINE_AA);
  }
}

}  // namespace

Stretch::Stretch(std::vector<float> values) {
  if (values.empty()) return;
  std::ranges::sort(values);
  const float high = values[values.size() - 1 - values.size() / 50];
  low_ = values[values.size() / 50];
  scale_ = high > low_ ? 255.0F / (high - low_) : 0.0F;
}

float Stretch::operator()(float value) const { return std::clamp(scale_ * (value - low_), 0.0F, 255.0F); }

cv::Mat plan_of(const PointTable& map, const Trajectory& trajectory, std::span<const Anomaly> alarms,
                const PlanConfig& config) {
  if (map.points.empty()) return {};
  Plan plan = plan_for(map, trajectory, config);
  const std::vector<float>* intensity = find_field(map, "intensity");
  const auto [level, seen] = levels(map, intensity ? *intensity : std::vector<float>(map.points.size(), 1.0F), plan);
  cv::Mat coloured, picture(plan.size(), CV_8UC3, cv::Scalar::all(28));
  cv::applyColorMap(level, coloured, cv::COLORMAP_INFERNO);
  if (!intensity) coloured = cv::Scalar::all(140);
  coloured.copyTo(picture, seen);
  const int before_px = picture.cols;
  picture = enlarged(picture, config.width_px);
  plan.px_per_m *= static_cast<double>(picture.cols) / before_px;
  std::vector<cv::Point> way;
  for (const StampedPose& pose : trajectory) way.push_back(plan.at(pose.T_W_I.translation().head<2>()));
  cv::polylines(picture, way, false, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  draw_alarms(picture, plan, alarms);
  draw_bar(picture, plan.px_per_m);
  return picture;
}

cv::Mat thermogram(const cv::Mat& raw) {
  if (raw.empty()) return {};
  constexpr int kHeight_px = 240;
  cv::Mat level, grey, colour, both;
  cv::normalize(raw, level, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  const double zoom = std::clamp(static_cast<double>(kHeight_px) / level.rows, 1.0, 8.0);
  cv::resize(level, level, {}, zoom, zoom, cv::INTER_CUBIC);
  cv::applyColorMap(level, colour, cv::COLORMAP_INFERNO);
  cv::cvtColor(level, grey, cv::COLOR_GRAY2BGR);
  cv::hconcat(colour, grey, both);
  return both;
}

std::string png_of(const cv::Mat& picture) {
  std::vector<unsigned char> png;
  cv::imencode(".png", picture, png);
  return {png.begin(), png.end()};
}

}  // namespace pllit
