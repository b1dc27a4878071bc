// Keys of the thermographic stage.
#include "pllit/slam/config_section.hpp"

namespace pllit {

namespace {

constexpr std::array<std::string_view, 5> kUnits{"auto", "grey", "count", "kelvin", "light"};
constexpr std::array<std::string_view, 4> kShapes{"auto", "bias", "affine", "curve"};

}  // namespace

void list_anomalies(Section section, ThermographyConfig& config) {
  section.choose(
      "unit", config.unit_choice, kUnits,
      "Of images: grey (gain control), raw count, kelvin, light (no heat is mapped); auto: 8 bits grey, 16 count.");
  section.add(PLLIT_KEY(counts_per_kelvin),
              "Of raw counts, from a calibration of your own: differences are then told in kelvin too; 0: not known.",
              "1/K", {0.0, 1e5});
  section.add(PLLIT_KEY(kelvin_per_count), "Of a radiometric camera.", "K", {1e-4, 10.0});
  section.add(PLLIT_KEY(kelvin_at_zero), "Of a radiometric camera: temperature of count zero.", "K", {-1000.0, 1000.0});
  section.add("max_range_m", config.sampling.max_range_m, "Surfaces farther from the camera are not watched.", "m",
              {0.5, 100.0});
  section.add("min_incidence_cos", config.sampling.min_cos_incidence,
              "Surfaces seen at a more grazing angle, by its cosine, are not watched.", "", {0.0, 1.0});
  section.add("seen_within_m", config.surface.memory_m,
              "Surfaces that the LiDAR has not measured on so much of the way are not looked for in images.", "m",
              {0.05, 100.0});
  section.add("voxel_m", config.map.voxel_m, "Voxel of the thermographic map.", "m", {0.01, 1.0});
  section.add("memory_mb", config.map.memory_mb,
              "Most memory it may take; beyond it what was not seen for longest goes.", "MB", {4.0, 1048576.0});
  VoxelModelConfig& model = config.map.model;
  section.add("noise", model.noise,
              "Least standard deviation of a voxel, in the unit of the images; 0: 6 greys or 0.3 K.", "", {0.0, 1e4});
  section.add("learned_after", model.learned_after,
              "Images before a voxel's normal intensity is known; 0: 12 of greys, 6 of others.", "", {0.0, 1000.0});
  section.add("learned_views", model.learned_views,
              "And from so many viewpoints, unless the rig stands; 0: 2 of greys, 1 of others.", "", {0.0, 100.0});
  section.add("adaptation", model.adaptation,
              "Weight of each later image: what is normal follows slow changes; 0: 0.02 of greys, 0.005 of others.", "",
              {0.0, 1.0});
  section.add("gate_sigmas", model.gate_sigmas, "A greater change is not normal, in standard deviations.", "",
              {1.0, 20.0});
  section.add("min_change", model.min_change,
              "A smaller change is never hot, in the unit of the images; 0: 30 greys or 3 K.", "", {0.0, 1e4});
  section.add("release_sigmas", model.release_sigmas, "What is hot stays so until it is within this.", "", {0.1, 20.0});
  section.add("hits", model.hits, "Images that must have shown a change.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(saturated_grey), "From here on, greys of 8-bit video say \"at least\".", "grey", {1.0, 255.0});
  section.choose("anchor", config.anchor_choice, kShapes,
                 "How images are tied to the map; auto: temperatures by a shift, counts by a line, greys by a curve.");
  section.add("anchor_loss", config.anchor.loss,
              "Surfaces that differ by more do not tie images to the map, in the images' unit; 0: 12 greys or 1.5 K.",
              "", {0.0, 1e4});
  section.add("seam_voxels", config.anomalies.watch.seam_voxels,
              "So near, heat that has always been there explains a change; -1: 2 of greys, 0 of others.", "",
              {-1.0, 10.0});
  section.add("min_voxels", config.anomalies.min_voxels, "Smaller clusters of hot voxels are noise.", "",
              {1.0, 10000.0});
  section.add("dwell_s", config.anomalies.dwell_s, "How long they must have been hot before the alarm.", "s",
              {0.0, 60.0});
  section.add(PLLIT_KEY(time_constant_s), "Of a bolometer's pixels; 0 for other sensors.", "s", {0.0, 0.1});
  section.add(PLLIT_KEY(shutter_pause_s), "Images so soon after the shutter opened do not count.", "s", {0.0, 60.0});
}

void list_radiometry(Section section, Radiometry& config) {
  section.add(PLLIT_KEY(emissivity), "Of the surfaces, 8 to 14 um; 1: apparent temperatures are kept.", "",
              {0.05, 1.0});
  section.add(PLLIT_KEY(reflected_K), "Apparent temperature of what the surfaces reflect.", "K", {100.0, 1500.0});
  section.add(PLLIT_KEY(air_K), "Temperature of the air between camera and surfaces.", "K", {100.0, 1500.0});
  section.add(PLLIT_KEY(absorbed_per_m), "Share that this air absorbs on each metre; 0: none.", "1/m", {0.0, 0.1});
}

}  // namespace pllit
