#include "pllit/thermal/decode_points.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

/// Centre of the scores' mass in the 5 x 5 pixels around a maximum, which must lie two pixels or more inside.
Eigen::Vector2f centre_of_mass(const cv::Mat& scores, int row, int column) {
  float mass = 0.0F;
  Eigen::Vector2f moment = Eigen::Vector2f::Zero();
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const float score = scores.at<float>(row + dy, column + dx);
      mass += score;
      moment += score * Eigen::Vector2f(static_cast<float>(dx), static_cast<float>(dy));
    }
  return Eigen::Vector2f(static_cast<float>(column), static_cast<float>(row)) + moment / mass;
}

/// The four cells around a place and their weights, one axis.
struct Between {
  int low, high;
  float share_high;
};

Between between(float at_px, int cells) {
  constexpr auto kStride = static_cast<float>(kDescriptorStride_px);
  const float at = std::clamp((at_px + 0.5F) / kStride - 0.5F, 0.0F, static_cast<float>(cells - 1));
  const int low = std::min(static_cast<int>(at), std::max(cells - 2, 0));
  return {low, std::min(low + 1, cells - 1), at - static_cast<float>(low)};
}

}  // namespace

std::vector<Corner> decode_points(const cv::Mat& scores, const cv::Size& image, const PointDecoding& config) {
  const int side = 2 * config.suppression_px + 1;
  cv::Mat best;
  cv::dilate(scores, best, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  const int margin = std::max(config.margin_px, 2);
  std::vector<Corner> points;
  for (int row = margin; row < image.height - margin; ++row) {
    const auto *score = scores.ptr<float>(row), *most = best.ptr<float>(row);
    for (int column = margin; column < image.width - margin; ++column)
      if (score[column] >= most[column] && score[column] > static_cast<float>(config.least_score))
        points.push_back({centre_of_mass(scores, row, column), score[column]});
  }
  std::ranges::stable_sort(points, std::ranges::greater{}, &Corner::strength);
  return spread_evenly(points, config.most, static_cast<float>(config.most_radius_px));
}

cv::Mat sample_descriptors(const MapView& descriptors, const std::vector<Corner>& points) {
  cv::Mat rows(static_cast<int>(points.size()), descriptors.channels, CV_32FC1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Between x = between(points[i].at_px.x(), descriptors.columns);
    const Between y = between(points[i].at_px.y(), descriptors.rows);
    Eigen::Map<Eigen::VectorXf> row(rows.ptr<float>(static_cast<int>(i)), descriptors.channels);
    for (int channel = 0; channel < descriptors.channels; ++channel) {
      const auto along_x = [&](int map_row) {
        return std::lerp(descriptors.at(channel, map_row, x.low), descriptors.at(channel, map_row, x.high),
                         x.share_high);
      };
      row[channel] = std::lerp(along_x(y.low), along_x(y.high), y.share_high);
    }
    row.normalize();
  }
  return rows;
}

}  // namespace pllit
