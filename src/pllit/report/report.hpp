// A session as one page that is read on a phone and printed: what was found, where, how sure, and what was not seen.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "pllit/map/radiometry.hpp"
#include "pllit/report/health_plot.hpp"
#include "pllit/report/severity.hpp"
#include "pllit/state/table.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// A stretch of frames in one state that is not good, with the reasons of the first.
struct DoubtfulStretch {
  double from_s = 0.0, to_s = 0.0;  ///< since 1970
  std::string state, reasons;
};

/// All that the page shows, as plain values. Positions in W.
struct ReportContent {
  std::string title;
  IntensityUnit unit = IntensityUnit::grey;
  double counts_per_kelvin = 0.0;  ///< of raw counts, as the user knows them; 0: no kelvin are claimed
  Radiometry radiometry{};         ///< what temperatures were corrected for
  double voxel_m = 0.05;           ///< of the thermographic map
  int known_after = 12;            ///< images of a surface before it is known what is normal there
  bool has_images = false;
  Trajectory trajectory{};
  PointTable map{};          ///< of the LiDAR
  PointTable thermal_map{};  ///< empty without images
  std::vector<Anomaly> anomalies{};
  std::map<std::uint32_t, cv::Mat> crops{};  ///< by the anomaly's number, as the camera gave them
  std::vector<DoubtfulStretch> doubts{};
  std::vector<HealthSample> health{};  ///< frame by frame
  SeverityTable severity = neta_100_18();
};

/// One self-contained page of HTML. `run` is the session's run.json.
std::string report_html(const ReportContent& content, const nlohmann::ordered_json& run);

}  // namespace pllit
