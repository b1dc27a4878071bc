// What has become abnormally hot: the finding that maps, writers and scores share.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// What a calibrated intensity counts. Only radiometric input gives kelvin: greys and counts never become a
/// temperature.
enum class IntensityUnit { grey, count, kelvin };

enum class AnomalyKind {
  heated,  ///< a surface that was known became hotter
  new_hot  ///< a surface where there was none before, hotter than what stands around it and what was seen behind it
};

enum class AnomalyState {
  fresh,      ///< seen, not yet for long enough
  confirmed,  ///< an alarm
  cooling,    ///< was confirmed; is no longer above the level that raised it
  gone        ///< was confirmed; is back to normal, or the surface is no longer there
};

constexpr std::string_view name_of(IntensityUnit unit) {
  return unit == IntensityUnit::grey ? "grey" : unit == IntensityUnit::count ? "count" : "kelvin";
}
constexpr std::string_view name_of(AnomalyKind kind) { return kind == AnomalyKind::heated ? "heated" : "new_hot"; }
constexpr std::string_view name_of(AnomalyState state) {
  return state == AnomalyState::fresh       ? "new"
         : state == AnomalyState::confirmed ? "confirmed"
         : state == AnomalyState::cooling   ? "cooling"
                                            : "gone";
}

/// Where in which image it shows: the pixels [left, left + width) x [top, top + height).
struct ImageCrop {
  Time time;  ///< of the image
  int left = 0, top = 0, width = 0, height = 0;
};

struct Anomaly {
  std::uint32_t id = 0;
  AnomalyKind kind = AnomalyKind::heated;
  AnomalyState state = AnomalyState::fresh;
  Vector3d position_W = Vector3d::Zero();       ///< centroid of the hot surface
  Matrix3d covariance_m2 = Matrix3d::Zero();    ///< of that centroid against the map around the robot
  Vector3d extent_m = Vector3d::Zero();         ///< of the box along W's axes that holds it
  double peak_change = 0.0, mean_change = 0.0;  ///< over voxels, in the unit of the map, against what is normal
  double peak_sigmas = 0.0, mean_sigmas = 0.0;  ///< the same in standard deviations of what is normal
  Time first_seen{}, last_seen{};
  std::optional<Time> confirmed{};  ///< when the alarm was raised
  int voxels = 0;                   ///< of the map, at its largest
  int frames = 0;                   ///< images that showed it hot
  int views = 0;                    ///< viewpoints a quarter of a metre apart
  double confidence = 0.0;          ///< 0 to 1, from contrast, size and views; not a probability
  std::optional<ImageCrop> crop{};  ///< the image in which it is largest
};

}  // namespace pllit
