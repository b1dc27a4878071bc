// The session folder of a run: written while the run goes on, so that it is complete even where the run was killed.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/io/csv.hpp"
#include "pllit/io/ply.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/state/table.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// `results/<recording>-<UTC>`, for instance results/hall-20261122T034215Z; `recording` is a file name or a simulator's
/// address, characters that do not belong in a folder's name become `_`.
std::filesystem::path default_session_folder(const std::filesystem::path& results, std::string_view recording,
                                             std::chrono::system_clock::time_point now);

/// Makes `latest`, beside the session, a link to it. Fails where `latest` is something other than a link.
Expected<void> link_latest(const std::filesystem::path& session);

/// What the streamed tables of a session hold.
struct SessionLayout {
  std::vector<std::string> health_columns;
  std::vector<std::string> map_fields;
};

/// Writes a session folder. Every call leaves readable files; after an error (a full disk) they hold what they held.
class SessionWriter {
 public:
  /// Creates the folder with empty trajectory.tum, odometry.tum, health.csv and map.ply. A folder that holds anything
  /// is refused with an input error that suggests a free name.
  static Expected<SessionWriter> create(const std::filesystem::path& folder, const SessionLayout& layout);

  /// Adds a pose to odometry.tum and to trajectory.tum.
  Expected<void> append_pose(const StampedPose& pose);
  Expected<void> append_health(std::span<const CsvCell> row) { return health_.append(row); }
  Expected<void> append_map(const PointTable& table);

  /// Replaces trajectory.tum as a whole, once loops are closed; poses appended later go to odometry.tum only.
  Expected<void> replace_trajectory(const Trajectory& trajectory);
  /// Replaces map.ply by itself, changed part by part; nothing can be appended to it later.
  Expected<void> change_map(const std::function<void(PointTable& part)>& change);
  /// Writes any other cloud of the session (thermal_map.ply).
  Expected<void> write_cloud(std::string_view name, const PointTable& table);
  /// Writes run.json; a reader sees the old one or the new one, never half of one.
  Expected<void> write_run(const nlohmann::ordered_json& run);
  /// Writes any other file of the session (anomalies.json, report.html) in the same way.
  Expected<void> write_text(std::string_view name, std::string_view text);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  SessionWriter(std::filesystem::path folder, TumWriter trajectory, TumWriter odometry, CsvWriter health, PlyStream map)
      : folder_(std::move(folder)),
        trajectory_(std::move(trajectory)),
        odometry_(std::move(odometry)),
        health_(std::move(health)),
        map_(std::move(map)) {}

  std::filesystem::path folder_;
  std::optional<TumWriter> trajectory_;  // none once the trajectory was replaced
  TumWriter odometry_;
  CsvWriter health_;
  std::optional<PlyStream> map_;  // none once the map was replaced
};

/// A session as it lies on the disk.
struct Session {
  std::filesystem::path folder;
  Trajectory trajectory;
  Trajectory odometry;
  CsvTable health;
  PointTable map;
  std::optional<nlohmann::ordered_json> run;  ///< none where the run was killed before it wrote one
};

/// Reads a session, finished or interrupted: unfinished last lines are ignored. Input errors name the file. Of a map
/// with more points than most_map_points it reads every n-th.
Expected<Session> open_session(const std::filesystem::path& folder,
                               std::size_t most_map_points = std::numeric_limits<std::size_t>::max());

}  // namespace pllit
