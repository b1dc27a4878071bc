#include "pllit/io/session.hpp"

#include <algorithm>
#include <cctype>
#include <format>
#include <system_error>
#include <utility>

#include "pllit/io/file.hpp"
#include "pllit/io/point_records.hpp"

namespace pllit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTrajectory = "trajectory.tum";
constexpr const char* kOdometry = "odometry.tum";
constexpr const char* kHealth = "health.csv";
constexpr const char* kMap = "map.ply";
constexpr const char* kRun = "run.json";

fs::path without_final_slash(const fs::path& folder) { return folder.has_filename() ? folder : folder.parent_path(); }

/// The folder's name with the first of -2, -3, ... that nothing has taken.
fs::path free_name(const fs::path& folder) {
  std::error_code status;
  for (int number = 2;; ++number) {
    const fs::path name = std::format("{}-{}", folder.string(), number);
    if (!fs::exists(name, status)) return name;
  }
}

Expected<void> make_folder(const fs::path& folder) {
  std::error_code status;
  if (fs::exists(folder, status) && !fs::is_directory(folder, status))
    return input_error(std::format("{} is a file; name a folder with --out", folder.string()));
  if (fs::exists(folder, status) && !fs::is_empty(folder, status))
    return input_error(
        std::format("{} is not empty and is never overwritten; name another folder, for example --out {}",
                    folder.string(), free_name(folder).string()));
  fs::create_directories(folder, status);
  if (status) return failure(std::format("cannot create {}: {}", folder.string(), status.message()));
  return {};
}

Expected<std::optional<nlohmann::ordered_json>> read_run(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) return std::nullopt;
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  auto run = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (run.is_discarded()) return input_error(std::format("{}: is not JSON", path.string()));
  return run;
}

}  // namespace

fs::path default_session_folder(const fs::path& results, std::string_view recording,
                                std::chrono::system_clock::time_point now) {
  std::string name = fs::path(recording.substr(0, recording.find('?'))).stem().string();
  const auto belongs = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.'; };
  std::ranges::replace_if(name, [&](char c) { return !belongs(static_cast<unsigned char>(c)); }, '_');
  return results / std::format("{}-{:%Y%m%dT%H%M%SZ}", name, std::chrono::floor<std::chrono::seconds>(now));
}

Expected<void> link_latest(const fs::path& session) {
  const fs::path target = without_final_slash(session), link = target.parent_path() / "latest";
  std::error_code status;
  const auto present = fs::symlink_status(link, status);
  if (fs::exists(present) && !fs::is_symlink(present))
    return failure(std::format("{} is not a link and stays as it is", link.string()));
  // A link cannot be changed; one that is renamed over it is never absent for a reader.
  const fs::path beside = link.string() + ".part";
  fs::remove(beside, status);
  fs::create_directory_symlink(target.filename(), beside, status);
  if (!status) fs::rename(beside, link, status);
  if (status) return failure(std::format("cannot link {} to {}: {}", link.string(), target.string(), status.message()));
  return {};
}

Expected<SessionWriter> SessionWriter::create(const fs::path& folder, const SessionLayout& layout) {
  if (auto made = make_folder(without_final_slash(folder)); !made) return std::unexpected(made.error());
  auto trajectory = TumWriter::create(folder / kTrajectory);
  if (!trajectory) return std::unexpected(trajectory.error());
  auto odometry = TumWriter::create(folder / kOdometry);
  if (!odometry) return std::unexpected(odometry.error());
  auto health = CsvWriter::create(folder / kHealth, layout.health_columns);
  if (!health) return std::unexpected(health.error());
  auto map = PlyStream::create(folder / kMap, layout.map_fields);
  if (!map) return std::unexpected(map.error());
  return SessionWriter(folder, std::move(*trajectory), std::move(*odometry), std::move(*health), std::move(*map));
}

Expected<void> SessionWriter::append_pose(const StampedPose& pose) {
  auto written = odometry_.append(pose);
  if (written && trajectory_) written = trajectory_->append(pose);
  return written;
}

Expected<void> SessionWriter::append_map(const PointTable& table) {
  if (!map_) return failure(std::format("{} was replaced and takes no more points", (folder_ / kMap).string()));
  return map_->append(table);
}

Expected<void> SessionWriter::replace_trajectory(const Trajectory& trajectory) {
  const fs::path path = folder_ / kTrajectory;
  auto replaced = write_tum(part_path(path), trajectory).and_then([&] { return put_in_place(path); });
  if (replaced) trajectory_.reset();
  return replaced;
}

Expected<void> SessionWriter::change_map(const std::function<void(PointTable&)>& change) {
  constexpr std::size_t kPart = 1 << 18;
  const fs::path path = folder_ / kMap;
  auto reader = PlyReader::open(path);
  if (!reader) return std::unexpected(reader.error());
  std::optional<PlyStream> changed;
  do {  // an empty map has one part too
    auto part = reader->next(kPart);
    if (!part) return std::unexpected(part.error());
    change(*part);
    if (!changed) {
      auto stream = PlyStream::create(part_path(path), field_names(*part));
      if (!stream) return std::unexpected(stream.error());
      changed.emplace(std::move(*stream));
    }
    if (auto written = changed->append(*part); !written) return written;
  } while (changed->size() < reader->size());
  auto replaced = changed->close().and_then([&] { return put_in_place(path); });
  if (replaced) map_.reset();
  return replaced;
}

Expected<void> SessionWriter::write_cloud(std::string_view name, const PointTable& table) {
  const fs::path path = folder_ / name;
  return write_ply(part_path(path), table).and_then([&] { return put_in_place(path); });
}

Expected<void> SessionWriter::write_run(const nlohmann::ordered_json& run) {
  return replace_file(folder_ / kRun, run.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

Expected<void> SessionWriter::write_text(std::string_view name, std::string_view text) {
  return replace_file(folder_ / name, text);
}

Expected<Session> open_session(const fs::path& folder, std::size_t most_map_points) {
  std::error_code status;
  if (!fs::is_directory(folder, status)) return input_error(std::format("{}: no such folder", folder.string()));
  if (!fs::exists(folder / kTrajectory, status))
    return input_error(std::format("{}: not a session (it holds no {})", folder.string(), kTrajectory));
  auto trajectory = read_interrupted_tum(folder / kTrajectory);
  if (!trajectory) return std::unexpected(trajectory.error());
  auto odometry = read_interrupted_tum(folder / kOdometry);
  if (!odometry) return std::unexpected(odometry.error());
  auto health = read_csv(folder / kHealth);
  if (!health) return std::unexpected(health.error());
  auto map = read_ply(folder / kMap, most_map_points);
  if (!map) return std::unexpected(map.error());
  auto run = read_run(folder / kRun);
  if (!run) return std::unexpected(run.error());
  return Session{folder,          std::move(*trajectory), std::move(*odometry), std::move(*health),
                 std::move(*map), std::move(*run)};
}

}  // namespace pllit
