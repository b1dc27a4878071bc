#include "pllit/state/camera_mount.hpp"

namespace pllit {

namespace ix = error_index;

CameraMount boxplus(const CameraMount& mount, const MountVector& error) {
  const SO3 R_I_C = mount.T_I_C.asSO3() * exp_so3(error.segment<3>(mount_index::theta));
  return {.T_I_C = pose_from(R_I_C, mount.T_I_C.translation() + error.segment<3>(mount_index::p)),
          .delay_s = mount.delay_s + error[mount_index::delay],
          .depth_stretch = mount.depth_stretch + error[mount_index::depth]};
}

MountVector boxminus(const CameraMount& a, const CameraMount& b) {
  MountVector error;
  error << log_so3(b.T_I_C.asSO3().inverse() * a.T_I_C.asSO3()), a.T_I_C.translation() - b.T_I_C.translation(),
      a.delay_s - b.delay_s, a.depth_stretch - b.depth_stretch;
  return error;
}

Exposure exposure(const NavState& state, double delay_s, const Vector3d& rate_I) {
  const SO3 turn = exp_so3(delay_s * rate_I);
  Exposure exposed{
      .T_W_I = pose_from(state.R_W_I * turn, state.p_W + delay_s * state.v_W), .J_state = {}, .J_delay = {}};
  exposed.J_state.setZero();
  exposed.J_state.block<3, 3>(ix::theta, ix::theta) = turn.inverse().rotation();
  exposed.J_state.block<3, 3>(ix::p, ix::p).setIdentity();
  exposed.J_state.block<3, 3>(ix::p, ix::v) = delay_s * Matrix3d::Identity();
  exposed.J_delay << rate_I, state.v_W;
  return exposed;
}

}  // namespace pllit
