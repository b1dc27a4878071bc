// Images of a simulation as files, with what they truly show beside each.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pllit/sim/simulation.hpp"

namespace pllit::app {

struct FrameChoice {
  int every = 1;  ///< images from one to the next that is written
  bool depth = false, temperature = false, edges = false;
};

/// One image in `every` as PNG; the index of all is frames.json (docs/SIMULATOR.md).
class FrameFolder {
 public:
  /// Input errors: the folder holds something and may not be overwritten, or the simulation has no images or has
  /// faults, among which images lose their truth.
  static Expected<FrameFolder> create(const std::filesystem::path& folder, const FrameChoice& choice, bool overwrite,
                                      const Simulation& simulation);

  /// An event that the simulation has just returned; other than images are passed over, and so are frozen images.
  Expected<void> write(const SensorEvent& event, Simulation& simulation);
  /// Writes the index.
  Expected<void> close(const Simulation& simulation, const std::string& address);

 private:
  FrameFolder(std::filesystem::path folder, const FrameChoice& choice) : folder_(std::move(folder)), choice_(choice) {}

  Expected<void> begin_frame(const CameraFrame& image, Simulation& simulation);
  Expected<void> write_png(const char* key, const cv::Mat& image);
  Expected<void> write_edges(const std::vector<ImageEdge>& edges);
  std::string file_name(const char* key, const char* extension) const;

  std::filesystem::path folder_;
  FrameChoice choice_;
  long images_ = 0;
  std::optional<Time> last_;  ///< when the last image was received: grey and counts come together
  bool chosen_ = false;       ///< whether it is written
  nlohmann::ordered_json frames_ = nlohmann::ordered_json::array();
};

}  // namespace pllit::app
