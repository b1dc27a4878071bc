// IMUs as their makers describe them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/sim/motion/imu.hpp"

namespace pllit {

/// Density of the walk that carries a bias by its in-run instability, the figure in data sheets, within 100 s
/// (assumed). For the VN-100's accelerometer (0.04 mg) this gives 3.9e-5 m/s3 per root Hz where its maker says 5e-5.
double bias_walk(double in_run_instability);

/// bmi085, bmi088, hi71, vn100, alphasense, vectornav_ntu4dradlm; their figures' sources stand in imu_models.cpp. Input
/// error: an unknown name.
Expected<ImuModel> imu_model(std::string_view name);
std::vector<std::string> imu_model_names();

}  // namespace pllit
