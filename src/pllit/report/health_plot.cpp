#include "pllit/report/health_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <format>
#include <string_view>
#include <vector>

namespace pllit {
namespace {

constexpr int kLeft = 130, kWidth = 760, kStrip = 14, kHeight = 60, kGap = 16;

/// The frames that share one column of the drawing.
struct Column {
  int frames = 0, state = 0;  ///< the worst
  double sigma_m = 0.0, matched = 0.0, speed_mps = 0.0;

  void add(const HealthSample& frame) {
    constexpr std::array<std::string_view, 4> kWorse{"good", "initialising", "degraded", "lost"};
    const auto rank = static_cast<int>(std::ranges::find(kWorse, frame.state) - kWorse.begin());
    state = std::max(state, std::min(rank, 3));
    sigma_m = std::max(sigma_m, frame.sigma_m);
    speed_mps = std::max(speed_mps, frame.speed_mps);
    matched = frames++ == 0 ? frame.matched : std::min(matched, frame.matched);
  }
};

std::vector<Column> columns_of(std::span<const HealthSample> frames) {
  const double from_s = frames.front().time_s, lasts_s = frames.back().time_s - from_s;
  const auto count = std::min<std::size_t>(kWidth / 2, frames.size());
  std::vector<Column> columns(count);
  for (const HealthSample& frame : frames) {
    const double at = (frame.time_s - from_s) / lasts_s * static_cast<double>(count);
    columns[std::min(count - 1, static_cast<std::size_t>(std::max(0.0, at)))].add(frame);
  }
  return columns;
}

/// The least of 1, 2 and 5 times a power of ten that is not below a value.
double round_above(double value) {
  const double ten = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-6))));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * ten >= value) return factor * ten;
  return 10.0 * ten;
}

double x_of(std::size_t column, std::size_t count) {
  return kLeft + static_cast<double>(column) * kWidth / static_cast<double>(count);
}

std::string strip_of(const std::vector<Column>& columns) {
  constexpr std::array kColours{"#3a3", "#888", "#d90", "#c22"};
  std::string svg;
  for (std::size_t i = 0; i < columns.size();) {
    std::size_t end = i + 1;
    while (end < columns.size() && columns[end].state == columns[i].state) ++end;
    svg += std::format("<rect x=\"{:.1f}\" y=\"0\" width=\"{:.1f}\" height=\"{}\" fill=\"{}\"/>\n",
                       x_of(i, columns.size()), x_of(end, columns.size()) - x_of(i, columns.size()), kStrip,
                       kColours[static_cast<std::size_t>(columns[i].state)]);
    i = end;
  }
  return svg + std::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">state</text>\n", kLeft - 8, kStrip - 2);
}

std::string curve_of(const std::vector<Column>& columns, double Column::* value, std::string_view name, int top) {
  const auto most = std::ranges::max_element(columns, {}, value);
  const double full = round_above((*most).*value);
  std::string points;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].frames > 0)
      points +=
          std::format("{:.1f},{:.1f} ", x_of(i, columns.size()), top + kHeight * (1.0 - columns[i].*value / full));
  return std::format(
      "<path d=\"M{0} {1}h{2}M{0} {3}h{2}\" stroke=\"#8886\"/><polyline points=\"{4}\" stroke=\"currentColor\"/>\n"
      "<text x=\"{5}\" y=\"{6}\" text-anchor=\"end\">{7:g}</text><text x=\"{5}\" y=\"{8}\" text-anchor=\"end\">{9}"
      "</text><text x=\"{5}\" y=\"{3}\" text-anchor=\"end\">0</text>\n",
      kLeft, top, kWidth, top + kHeight, points, kLeft - 8, top + 10, full, top + kHeight / 2 + 5, name);
}

}  // namespace

std::string health_plot(std::span<const HealthSample> frames) {
  if (frames.size() < 2 || !(frames.back().time_s > frames.front().time_s)) return "";
  const std::vector<Column> columns = columns_of(frames);
  std::string svg = strip_of(columns);
  int top = kStrip + kGap;
  const auto add = [&](double Column::* value, std::string_view name) {
    svg += curve_of(columns, value, name, top);
    top += kHeight + kGap;
  };
  add(&Column::sigma_m, "sigma, m");
  add(&Column::matched, "matched points");
  add(&Column::speed_mps, "speed, m/s");
  svg += std::format("<text x=\"{}\" y=\"{}\">0 s</text><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.0f} s</text>\n",
                     kLeft, top + 4, kLeft + kWidth, top + 4, frames.back().time_s - frames.front().time_s);
  return std::format(
      "<svg role=\"img\" aria-label=\"State, sigma, matched points and speed over time\" viewBox=\"0 0 {} {}\" "
      "fill=\"none\" "
      "style=\"width:100%;height:auto;margin-top:1rem\"><style>text{{font-size:13px;fill:currentColor}}</style>{}</svg>\n",
      kLeft + kWidth + 10, top + 10, svg);
}

}  // namespace pllit
