// Keys of the camera's part.
#include "pllit/slam/config_section.hpp"

namespace pllit {

void list_thermal(Section section, VisionConfig& config) {
  section.add_switch(PLLIT_KEY(enabled), "Refine the LiDAR's pose with the images, thermal or visible.");
  section.add_switch(PLLIT_KEY(photometric), "Calibrate the greys of 8-bit images against gain control.");
  section.add_switch("weights", config.residuals.weights, "Give points on matched lines more weight.");
  section.add_switch("lines", config.residuals.lines, "Match straight edges with explicit 3D lines of the map.");
}

void list_features(Section section, VisionConfig& config) {
  section.add(PLLIT_KEY(model),
              "What finds points and lines: classical, or the file of a network (models/pl_net.onnx).");
}

void list_vision(Section section, VisionConfig& config) {
  section.add(PLLIT_KEY(provider), "Execution provider of a network: cpu, or cuda, tensorrt where they are installed.");
  section.add(PLLIT_KEY(threads), "Threads for a network.", "", {1.0, 64.0});
  section.add("image_spacing_s", config.image_spacing, "Images that follow sooner are left out.", "s", {0.0, 10.0});
  section.add(PLLIT_KEY(T_I_C_turn_deg),
              "How well the camera's attitude on the rig is known, one sigma; it is refined.", "deg", {1e-4, 20.0});
  section.add(PLLIT_KEY(T_I_C_shift_m), "How well its place on the rig is known, one sigma; it is refined.", "m",
              {1e-5, 1.0});
  section.add(PLLIT_KEY(delay_sigma_s),
              "How well the camera's delay is known, one sigma; it is refined. 0: it is right.", "s", {0.0, 1.0});
  section.add(PLLIT_KEY(depth_stretch_sigma),
              "How well LiDAR ranges are known, one sigma, as a share; refined. 0: they are right.", "", {0.0, 0.1});
  section.add(PLLIT_KEY(depth_window_s), "LiDAR points that give features their depth are at most so old.", "s",
              {0.05, 30.0});
  section.add(PLLIT_KEY(most_misfit),
              "An image whose residuals are more than this multiple of the expected is not believed.", "", {1.0, 1e6});
  section.add(PLLIT_KEY(least_inliers), "Fewer residuals that fit tell too little.", "", {3.0, 1e6});
  section.add("most_points", config.classical.most_points, "Features of an image, at most.", "", {20.0, 10000.0});
  section.add("keyframe_points", config.keyframes.most_points, "Features of a keyframe, at most.", "", {20.0, 10000.0});
  section.add("window_px", config.matching.window_px, "How far from the prediction a feature is looked for.", "px",
              {1.0, 500.0});
  section.add_switch("align", config.matching.align.enabled, "Lay points of known depth on the image itself.");
  section.add("keyframes", config.keyframes.most, "Keyframes that images are matched with.", "", {3.0, 50.0});
  section.add("point_sigma_px", config.residuals.point_sigma_px, "Noise of a matched point, one sigma.", "px",
              {0.05, 50.0});
  section.add("aligned_sigma_px", config.residuals.aligned_sigma_px, "Noise of one that was aligned.", "px",
              {0.05, 50.0});
  section.add("line_sigma_px", config.residuals.line_sigma_px, "Noise of a line's end across it, one sigma.", "px",
              {0.05, 50.0});
  section.add("gate", config.residuals.gate, "Residuals beyond this many standard deviations do not count.", "",
              {0.1, 100.0});
  section.add("max_information", config.residuals.max_information,
              "Of how many points an image may say as much, at most; 0: no limit.", "", {0.0, 1e6});
  section.add("common_shift_m", config.residuals.common_shift_m,
              "What an image can tell a shift to at best, one sigma; 0: no limit.", "m", {0.0, 1.0});
  section.add("weight_gain", config.residuals.weight_gain, "Weight of a point on a line (the paper's eta).", "",
              {1.0, 10.0});
  section.add("weight_sigma_px", config.residuals.weight_sigma_px,
              "Distance from the line at which the extra weight fades (the paper's sigma).", "px", {0.1, 50.0});
}

}  // namespace pllit
