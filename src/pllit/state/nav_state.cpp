#include "pllit/state/nav_state.hpp"

namespace pllit {

namespace ix = error_index;

NavState boxplus(const NavState& state, const Vector18& error) {
  NavState result = state;
  result.R_W_I = state.R_W_I * exp_so3(error.segment<3>(ix::theta));
  result.p_W += error.segment<3>(ix::p);
  result.v_W += error.segment<3>(ix::v);
  result.gyro_bias += error.segment<3>(ix::bg);
  result.accel_bias += error.segment<3>(ix::ba);
  result.gravity_W += error.segment<3>(ix::g);
  return result;
}

Vector18 boxminus(const NavState& a, const NavState& b) {
  Vector18 error;
  error << log_so3(b.R_W_I.inverse() * a.R_W_I), a.p_W - b.p_W, a.v_W - b.v_W, a.gyro_bias - b.gyro_bias,
      a.accel_bias - b.accel_bias, a.gravity_W - b.gravity_W;
  return error;
}

}  // namespace pllit
