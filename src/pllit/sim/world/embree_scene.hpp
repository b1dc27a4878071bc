// Embree's handles, and a scene from a mesh; for ray_caster.cpp alone.
#pragma once

#include <embree4/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "pllit/sim/world/mesh.hpp"

namespace pllit {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

/// Embree reports out of memory or an unusable processor here: nothing that a caller could mend.
inline void check(RTCDevice device) {
  if (rtcGetDeviceError(device) == RTC_ERROR_NONE) return;
  const char* message = rtcGetDeviceLastErrorMessage(device);
  throw std::runtime_error("the ray caster's Embree library failed: " + std::string(message ? message : "no reason"));
}

/// Builds on one thread alone, so that the tree, and with it which of two coinciding triangles is hit, is always the
/// same.
inline void commit(RTCDevice device, RTCScene scene) {
  tbb::task_arena alone(1);
  alone.execute([scene] { rtcJoinCommitScene(scene); });
  check(device);
}

inline Owned<RTCScene> new_scene(RTCDevice device) {
  Owned<RTCScene> scene(rtcNewScene(device));
  check(device);
  return scene;
}

/// A scene of one mesh in the mesh's own frame.
inline Owned<RTCScene> scene_of(RTCDevice device, const Mesh& mesh) {
  Owned<RTCScene> scene = new_scene(device);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);  // rays run faster; meshes are built but once
  const Owned<RTCGeometry> geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  if (!mesh.triangles.empty()) {
    using Vertex = std::array<float, 3>;
    using Triangle = std::array<std::uint32_t, 3>;
    auto* vertices = static_cast<Vertex*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vertex), mesh.vertices.size()));
    auto* triangles = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
    check(device);
    std::ranges::transform(mesh.vertices, vertices, [](const Vector3f& v) { return Vertex{v.x(), v.y(), v.z()}; });
    std::ranges::copy(mesh.triangles, triangles);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene.get(), geometry.get());
  commit(device, scene.get());
  return scene;
}

}  // namespace pllit
