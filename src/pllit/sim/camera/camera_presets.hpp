// Cameras that exist, as far as their makers and users tell.
#pragma once

#include "pllit/sim/camera/thermal_camera.hpp"
#include "pllit/sim/camera/visible_camera.hpp"

namespace pllit {

/// Botu TB640 class: 640 x 512 pixels of 12 um, 45 degrees across, NETD 50 mK; the rest is assumed.
ThermalCameraModel botu_tb640();
/// FLIR Boson 640 with the 50 degree lens (8.7 mm): NETD 40 mK. It delivers 60 Hz, here every second frame.
ThermalCameraModel boson_640();
/// The thermal camera of NTU4DRadLM: users' K for 640 x 480, the middle of the sensor's 640 x 512. Video with plateau
/// equalisation; distortion is assumed to be removed.
ThermalCameraModel ntu4dradlm_thermal();

/// cam0 of the Hilti-Oxford 2022 rig at 10 Hz: 720 x 540, equidistant (the calibration that FAST-LIVO2 uses).
VisibleCameraModel hilti2022_cam0();
/// T_I_C of that camera: IMU from LiDAR and camera from LiDAR as FAST-LIVO2 uses them.
SE3 hilti2022_T_I_cam0();
/// The organisers' IMU <- LiDAR of that rig.
SE3 hilti2022_T_I_lidar();

}  // namespace pllit
