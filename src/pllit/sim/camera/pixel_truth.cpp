#include "pllit/sim/camera/pixel_truth.hpp"

namespace pllit {

PixelTruth pixel_truth(const RayTable& table, const RayCaster& caster, const Heat& heat, const SE3& T_W_C,
                       Arena& arena) {
  const cv::Size size(table.width(), table.height());
  PixelTruth truth{cv::Mat::zeros(size, CV_32FC1), cv::Mat::zeros(size, CV_32FC1), cv::Mat::zeros(size, CV_32FC1)};
  const Matrix3d R_W_C = T_W_C.rotation();
  const Vector3d p_W = T_W_C.translation();
  arena.for_chunks(static_cast<std::size_t>(size.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int column = 0; column < size.width; ++column) {
        const Vector3f ray_C = table.at(column, row, 0.5F, 0.5F);
        const Ray ray{p_W, R_W_C * ray_C.cast<double>()};
        const Hit hit = caster.cast(ray);
        auto& temperature_K = truth.temperature_K.at<float>(row, column);
        temperature_K =
            hit ? heat.temperature_K(hit, heat.in_sun(caster, ray, hit)) : heat.sky_K(ray.direction_W.cast<float>());
        if (!hit) continue;
        truth.range_m.at<float>(row, column) = hit.range_m;
        truth.depth_m.at<float>(row, column) = hit.range_m * ray_C.z();
      }
  });
  return truth;
}

}  // namespace pllit
