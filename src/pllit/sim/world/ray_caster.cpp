#include "pllit/sim/world/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "pllit/sim/world/embree_scene.hpp"

namespace pllit {
namespace {

/// How far the rig may be from where tiles and coordinates were last arranged around it.
constexpr double kSlack_m = 16.0;
/// Texture coordinates of static things are taken modulo this, tile by tile: float then resolves 0.06 mm.
constexpr double kTextureWrap_m = 1024.0;
const Vector3d kNowhere = Vector3d::Constant(std::numeric_limits<double>::infinity());
/// What blocked() leaves out at either end.
constexpr float kBlockedMargin_m = 1e-3F;
/// No wider ones, where a processor has them: the same seed gives the same bytes on all machines.
constexpr const char* kInstructions = "max_isa=avx2";

/// A mesh placed in the world: a tile or an actor.
struct Part {
  Owned<RTCScene> scene;
  Owned<RTCGeometry> instance;
  std::vector<std::uint32_t> surface;
  std::vector<float> warmer_K;
  SE3 T_W_O = SE3::Identity();
  Matrix3d R_O_W = Matrix3d::Identity();
  Vector3d texture_shift_O = Vector3d::Zero();  ///< tile: from its frame to where its textures are read
  std::uint32_t actor = Hit::kStatic;
  unsigned slot = 0;  ///< Embree's number for the instance
  Vector3d put_about_W = kNowhere;
};

Part part_of(RTCDevice device, const Mesh& mesh) {
  Part part;
  part.scene = scene_of(device, mesh);
  part.surface = mesh.surface;
  part.warmer_K = mesh.warmer_K;
  part.instance.reset(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(part.instance.get(), part.scene.get());
  check(device);
  return part;
}

/// Puts the part at a pose, in Embree's coordinates: axes of W about centre_W. False where it is there already.
bool put(Part& part, const SE3& T_W_O, const Vector3d& centre_W) {
  if (part.put_about_W == centre_W && part.T_W_O.coeffs() == T_W_O.coeffs()) return false;
  part.put_about_W = centre_W;
  part.T_W_O = T_W_O;
  part.R_O_W = T_W_O.rotation().transpose();
  Eigen::Matrix<float, 3, 4> T;
  T << T_W_O.rotation().cast<float>(), (T_W_O.translation() - centre_W).cast<float>();
  rtcSetGeometryTransform(part.instance.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, T.data());
  rtcCommitGeometry(part.instance.get());
  return true;
}

RTCRay embree_ray(const Vector3d& origin, const Vector3d& direction, float near_m, float far_m) {
  const Vector3f o = origin.cast<float>(), d = direction.cast<float>();
  return {.org_x = o.x(),
          .org_y = o.y(),
          .org_z = o.z(),
          .tnear = near_m,
          .dir_x = d.x(),
          .dir_y = d.y(),
          .dir_z = d.z(),
          .time = 0.0F,
          .tfar = far_m,
          .mask = ~0U,
          .id = 0,
          .flags = 0};
}

/// So many rays side by side.
constexpr std::size_t kPacket = 8;

void put(RTCRay8& packet, std::size_t lane, const RTCRay& ray) {
  packet.org_x[lane] = ray.org_x;
  packet.org_y[lane] = ray.org_y;
  packet.org_z[lane] = ray.org_z;
  packet.tnear[lane] = ray.tnear;
  packet.dir_x[lane] = ray.dir_x;
  packet.dir_y[lane] = ray.dir_y;
  packet.dir_z[lane] = ray.dir_z;
  packet.tfar[lane] = ray.tfar;
  packet.mask[lane] = ray.mask;
}

}  // namespace

struct RayCaster::Scene {
  Scene(const Place& place_to_cast_in, double reach);

  void arrange(const Vector3d& p_W);
  void exchange_tiles(const Vector3d& p_W);
  void pose_actors(double t_s);
  void attach(Part& part);
  void detach(Part& part);
  RTCRay going(const Ray& ray) const;
  RTCRay between(const Vector3d& from_W, const Vector3d& way_W) const;
  Hit hit_of(const Ray& ray, float range_m, const Vector3f& normal_O, unsigned slot_hit, unsigned triangle) const;

  const Place& world;
  double reach_m;
  Owned<RTCDevice> device;
  Owned<RTCScene> top;
  std::map<std::uint32_t, Part> tiles;
  std::vector<Part> actors;
  std::vector<bool> present;         ///< which actors are attached
  std::vector<const Part*> part_at;  ///< by Embree's number
  Vector3d centre_W;                 ///< origin of Embree's coordinates
  bool changed = true;               ///< since the last commit
};

RayCaster::Scene::Scene(const Place& place_to_cast_in, double reach)
    : world(place_to_cast_in), reach_m(reach), device(rtcNewDevice(kInstructions)), centre_W(kNowhere) {
  check(device.get());
  top = new_scene(device.get());
  for (const Actor& actor : world.actors()) {
    actors.push_back(part_of(device.get(), actor.mesh_O));
    actors.back().actor = static_cast<std::uint32_t>(actors.size() - 1);
  }
  present.resize(actors.size(), false);
}

void RayCaster::Scene::attach(Part& part) {
  part.slot = rtcAttachGeometry(top.get(), part.instance.get());
  if (part.slot >= part_at.size()) part_at.resize(part.slot + 1, nullptr);
  part_at[part.slot] = &part;
  changed = true;
}

void RayCaster::Scene::detach(Part& part) {
  rtcDetachGeometry(top.get(), part.slot);
  part_at[part.slot] = nullptr;
  changed = true;
}

void RayCaster::Scene::exchange_tiles(const Vector3d& p_W) {
  const auto kept = world.tiles_near(p_W, reach_m + 3.0 * kSlack_m);
  std::erase_if(tiles, [&](auto& tile) {
    const bool far = !std::ranges::binary_search(kept, tile.first);
    if (far) detach(tile.second);
    return far;
  });
  for (const std::uint32_t index : world.tiles_near(p_W, reach_m + kSlack_m)) {
    if (tiles.contains(index)) continue;
    const Tile tile = world.tile(index);
    Part& part = tiles.emplace(index, part_of(device.get(), tile.mesh)).first->second;
    part.T_W_O = pose_from(SO3::Identity(), tile.origin_W);
    part.texture_shift_O = tile.origin_W - kTextureWrap_m * (tile.origin_W / kTextureWrap_m).array().round().matrix();
    attach(part);
  }
}

void RayCaster::Scene::arrange(const Vector3d& p_W) {
  if ((p_W - centre_W).norm() <= kSlack_m) return;
  exchange_tiles(p_W);
  // Whole metres, so that tiles with such origins are placed without rounding.
  centre_W = p_W.array().round();
  for (auto& [index, part] : tiles) changed |= put(part, part.T_W_O, centre_W);
}

void RayCaster::Scene::pose_actors(double t_s) {
  for (std::size_t i = 0; i < actors.size(); ++i) {
    const Actor& actor = world.actors()[i];
    const bool now = actor.present(t_s);
    if (now && !present[i]) attach(actors[i]);
    if (!now && present[i]) detach(actors[i]);
    present[i] = now;
    if (now) changed |= put(actors[i], actor.pose(t_s), centre_W);
  }
}

/// normal_O: along it; slot_hit: of the instance.
Hit RayCaster::Scene::hit_of(const Ray& ray, float range_m, const Vector3f& normal_O, unsigned slot_hit,
                             unsigned triangle) const {
  const Part& part = *part_at[slot_hit];
  Vector3f normal_W = normal_O.normalized();
  Vector3d p_own = ray.origin_W + static_cast<double>(range_m) * ray.direction_W - part.T_W_O.translation();
  if (part.actor == Hit::kStatic) {
    p_own += part.texture_shift_O;
  } else {
    p_own = part.R_O_W * p_own;
    normal_W = part.R_O_W.transpose().cast<float>() * normal_W;
  }
  if (normal_W.dot(ray.direction_W.cast<float>()) > 0.0F) normal_W = -normal_W;
  return {.range_m = range_m,
          .normal_W = normal_W,
          .p_own = p_own.cast<float>(),
          .surface = part.surface[triangle],
          .warmer_K = part.warmer_K[triangle],
          .actor = part.actor};
}

RayCaster::RayCaster(const Place& place, double reach_m) : scene_(std::make_unique<Scene>(place, reach_m)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

void RayCaster::move_to(const Vector3d& p_W, double t_s) {
  scene_->arrange(p_W);
  scene_->pose_actors(t_s);
  if (std::exchange(scene_->changed, false)) commit(scene_->device.get(), scene_->top.get());
}

RTCRay RayCaster::Scene::going(const Ray& ray) const {
  return embree_ray(ray.origin_W - centre_W, ray.direction_W, 0.0F, static_cast<float>(reach_m));
}

/// From a little behind one point to a little before the other.
RTCRay RayCaster::Scene::between(const Vector3d& from_W, const Vector3d& way_W) const {
  const double length_m = way_W.norm();
  return embree_ray(from_W - centre_W, way_W / length_m, kBlockedMargin_m,
                    static_cast<float>(length_m) - kBlockedMargin_m);
}

Hit RayCaster::cast(const Ray& ray) const {
  RTCRayHit answer{.ray = scene_->going(ray), .hit = {}};
  answer.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->top.get(), &answer);
  const RTCHit& hit = answer.hit;
  if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return scene_->hit_of(ray, answer.ray.tfar, {hit.Ng_x, hit.Ng_y, hit.Ng_z}, hit.instID[0], hit.primID);
}

void RayCaster::cast(std::span<const Ray> rays, std::span<Hit> hits) const {
  RTCIntersectArguments side_by_side;
  rtcInitIntersectArguments(&side_by_side);
  side_by_side.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  for (std::size_t begin = 0; begin < rays.size(); begin += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - begin);
    alignas(32) std::array<int, kPacket> valid{};
    RTCRayHit8 answer{};
    for (std::size_t i = 0; i < count; ++i) {
      valid[i] = -1;
      put(answer.ray, i, scene_->going(rays[begin + i]));
      answer.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), scene_->top.get(), &answer, &side_by_side);
    const RTCHit8& hit = answer.hit;
    for (std::size_t i = 0; i < count; ++i)
      hits[begin + i] = hit.geomID[i] == RTC_INVALID_GEOMETRY_ID
                            ? Hit{}
                            : scene_->hit_of(rays[begin + i], answer.ray.tfar[i],
                                             {hit.Ng_x[i], hit.Ng_y[i], hit.Ng_z[i]}, hit.instID[0][i], hit.primID[i]);
  }
}

bool RayCaster::blocked(const Vector3d& from_W, const Vector3d& to_W) const {
  RTCRay ray = scene_->between(from_W, to_W - from_W);
  if (ray.tfar <= ray.tnear) return false;
  rtcOccluded1(scene_->top.get(), &ray);
  return ray.tfar < 0.0F;
}

void RayCaster::blocked(std::span<const Vector3d> from_W, const Vector3d& way_W, std::span<bool> answers) const {
  RTCOccludedArguments side_by_side;
  rtcInitOccludedArguments(&side_by_side);
  side_by_side.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  for (std::size_t begin = 0; begin < from_W.size(); begin += kPacket) {
    const std::size_t count = std::min(kPacket, from_W.size() - begin);
    alignas(32) std::array<int, kPacket> valid{};
    RTCRay8 rays{};
    for (std::size_t i = 0; i < count; ++i) {
      const RTCRay ray = scene_->between(from_W[begin + i], way_W);
      valid[i] = ray.tfar > ray.tnear ? -1 : 0;
      put(rays, i, ray);
    }
    rtcOccluded8(valid.data(), scene_->top.get(), &rays, &side_by_side);
    for (std::size_t i = 0; i < count; ++i) answers[begin + i] = valid[i] != 0 && rays.tfar[i] < 0.0F;
  }
}

}  // namespace pllit
