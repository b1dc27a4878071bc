#include "pllit/report/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <opencv2/imgproc.hpp>

#include "pllit/report/pictures.hpp"

namespace pllit {
namespace {

constexpr int kLeastWidth_px = 640;  // of an image on the sheet
constexpr int kCaption_px = 26;
constexpr std::size_t kDense = 30000;  // points: with as many, small dots show more of the image

/// Grey, 8 bits, in three channels.
cv::Mat to_be_drawn_on(const cv::Mat& counts, int zoom) {
  cv::Mat grey = counts;
  if (grey.channels() == 3) cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, CV_32F);
  const Stretch stretch(std::vector<float>(grey.begin<float>(), grey.end<float>()));
  std::ranges::for_each(grey.begin<float>(), grey.end<float>(), [&](float& value) { value = stretch(value); });
  cv::Mat colour;
  grey.convertTo(grey, CV_8U);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  cv::resize(colour, colour, {}, zoom, zoom, cv::INTER_LINEAR);
  return colour;
}

/// Ranges that most points lie within, over all images.
std::pair<double, double> ranges_of(std::span<const OverlayImage> images) {
  std::vector<double> ranges_m;
  for (const OverlayImage& image : images)
    for (const Eigen::Vector3f& p_C : image.points_C)
      if (p_C.z() > 0.0F) ranges_m.push_back(static_cast<double>(p_C.norm()));
  if (ranges_m.empty()) return {1.0, 2.0};
  std::ranges::sort(ranges_m);
  const auto share = [&](double s) { return ranges_m[static_cast<std::size_t>(s * double(ranges_m.size() - 1))]; };
  const double near_m = std::max(0.1, share(0.02));
  return {near_m, std::max(1.1 * near_m, share(0.98))};
}

/// 256 colours from near to far, without the dark ends of the scale.
cv::Mat palette() {
  cv::Mat levels(1, 256, CV_8UC1), colours;
  for (int i = 0; i < 256; ++i) levels.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(240 - 200 * i / 255);
  cv::applyColorMap(levels, colours, cv::COLORMAP_TURBO);
  return colours;
}

void draw_points(cv::Mat& picture, const OverlayImage& image, const Camera& camera, int zoom,
                 const std::pair<double, double>& ranges_m) {
  const cv::Mat colours = palette();
  const int radius_px = zoom + (image.points_C.size() < kDense ? 1 : 0);
  const double scale = 255.0 / std::log(ranges_m.second / ranges_m.first);
  for (const Eigen::Vector3f& point_C : image.points_C) {
    const Vector3d p_C = point_C.cast<double>();
    const auto px = camera.project(p_C);
    if (!px) continue;
    const cv::Point at(static_cast<int>(std::lround(zoom * px->x())), static_cast<int>(std::lround(zoom * px->y())));
    if (at.x < 0 || at.y < 0 || at.x >= picture.cols || at.y >= picture.rows) continue;
    const double level = std::clamp(scale * std::log(p_C.norm() / ranges_m.first), 0.0, 255.0);
    const auto colour = colours.at<cv::Vec3b>(0, static_cast<int>(level));
    cv::circle(picture, at, radius_px, cv::Scalar(colour[0], colour[1], colour[2]), cv::FILLED);
  }
}

}  // namespace

cv::Mat overlay_sheet(std::span<const OverlayImage> images, const Camera& camera) {
  if (images.empty()) return {};
  const int zoom = std::max(1, (kLeastWidth_px + camera.width - 1) / camera.width);
  const int columns = images.size() > 1 ? 2 : 1, rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  const cv::Size cell(zoom * camera.width, zoom * camera.height + kCaption_px);
  cv::Mat sheet = cv::Mat::zeros(rows * cell.height, columns * cell.width, CV_8UC3);
  const auto ranges_m = ranges_of(images);
  for (std::size_t i = 0; i < images.size(); ++i) {
    cv::Mat picture = to_be_drawn_on(images[i].counts, zoom);
    draw_points(picture, images[i], camera, zoom, ranges_m);
    const cv::Point corner(static_cast<int>(i) % columns * cell.width, static_cast<int>(i) / columns * cell.height);
    picture.copyTo(sheet(cv::Rect(corner + cv::Point(0, kCaption_px), picture.size())));
    const std::string caption =
        std::format("{}; red {:.1f} m, blue {:.1f} m", images[i].caption, ranges_m.first, ranges_m.second);
    cv::putText(sheet, caption, corner + cv::Point(8, 18), cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(255), 1,
                cv::LINE_AA);
  }
  return sheet;
}

}  // namespace pllit
