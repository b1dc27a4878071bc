#include "pllit/map/visit_drift.hpp"

#include <algorithm>
#include <cmath>

#include "pllit/geometry/voxel_neighbours.hpp"

namespace pllit {
namespace {

double median_variance(std::span<const SharedVoxel> shared) {
  std::vector<double> variances;
  for (const SharedVoxel& voxel : shared)
    variances.push_back(voxel.sigma_before * voxel.sigma_before + voxel.sigma_now * voxel.sigma_now);
  if (variances.empty()) return 0.0;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::ranges::nth_element(variances, middle);
  return *middle;
}

/// `usual_variance`: of most voxels. What either visit knew only in doubt ties the visits but supports no claim.
AnchorPair pair_of(const SharedVoxel& voxel, double usual_variance) {
  constexpr double kImages = 10.0;  // that a mean stands for, of those that its spread was taken from
  const double variance = voxel.sigma_before * voxel.sigma_before + voxel.sigma_now * voxel.sigma_now;
  return {.now = static_cast<float>(voxel.now),
          .normal = static_cast<float>(voxel.before),
          .normal_variance = static_cast<float>(voxel.sigma_before * voxel.sigma_before / kImages),
          .trust = static_cast<float>(std::min(1.0, usual_variance / std::max(1e-12, variance)))};
}

}  // namespace

VisitDrift::VisitDrift(std::span<const SharedVoxel> shared, const VisitDriftConfig& config) : block_m_(config.block_m) {
  const double usual = median_variance(shared);
  std::vector<AnchorPair> pairs;
  std::map<VoxelKey, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < shared.size(); ++i) {
    pairs.push_back(pair_of(shared[i], usual));
    members[voxel_key(voxel_of(shared[i].p_W.cast<float>(), 1.0 / block_m_))].push_back(i);
  }
  whole_ = anchor_curve(pairs, {}, config.curve);
  const bool shifts = config.most_shift > 0.0;  // of what the whole site's curve gives
  AnchorConfig local = config.curve;
  if (shifts) {
    local.shape = AnchorConfig::Shape::bias;
    for (AnchorPair& pair : pairs) pair.now = static_cast<float>(whole_.curve(pair.now));
  }
  const int reach = static_cast<int>(std::ceil(config.reach_m / block_m_));
  for (const auto& [key, own] : members) {
    const Vector3d centre_W = block_m_ * (voxel_of_key(key).cast<double>() + Vector3d::Constant(0.5));
    std::vector<AnchorPair> around;
    for_neighbours(key, reach, [&](VoxelKey next) {
      const auto found = members.find(next);
      if (found == members.end()) return;
      for (const std::size_t i : found->second)
        if ((shared[i].p_W - centre_W).squaredNorm() < config.reach_m * config.reach_m) around.push_back(pairs[i]);
    });
    AnchorFit fit = anchor_curve(around, shifts ? AnchorCurve{} : whole_.curve, local);
    if (shifts) {
      const double shift = fit.curve.bias;
      fit.holds = fit.holds && whole_.holds && std::abs(shift) <= config.most_shift;
      fit.curve = whole_.curve;
      fit.curve.bias += shift;
    }
    if (fit.holds || whole_.holds) covered_ += static_cast<double>(own.size()) / static_cast<double>(shared.size());
    if (fit.holds) blocks_.emplace(key, std::move(fit));
  }
}

std::optional<BroughtIntensity> VisitDrift::bring(const Vector3d& p_W, double intensity) const {
  const auto block = blocks_.find(voxel_key(voxel_of(p_W.cast<float>(), 1.0 / block_m_)));
  const AnchorFit& fit = block == blocks_.end() ? whole_ : block->second;
  if (!fit.holds) return std::nullopt;
  // The spread of the whole site and of the surfaces here that the curve fits: a large thing that has changed is half
  // of what stands around it, and must not make itself doubtful.
  const double spread = std::max(fit.rms, whole_.holds ? whole_.spread : fit.spread);
  return BroughtIntensity{fit.curve(intensity), std::hypot(spread, fit.curve.doubt(intensity))};
}

}  // namespace pllit
