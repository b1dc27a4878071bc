#include "session_loops.hpp"

#include "pllit/io/csv.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/slam/frame_table.hpp"

namespace pllit::app {
namespace {

Expected<void> write_candidates(const std::filesystem::path& file, const std::vector<LoopRecord>& records) {
  auto csv = CsvWriter::create(file, loop_columns());
  if (!csv) return std::unexpected(csv.error());
  for (const LoopRecord& record : records)
    if (const auto done = csv->append(loop_row(record)); !done) return done;
  return csv->close();
}

}  // namespace

Expected<void> write_loops(SessionWriter& session, const LoopResult& loops) {
  if (const auto done = write_candidates(session.folder() / "loops.csv", loops.records); !done) return done;
  if (!loops.closed()) return {};
  const auto odometry = read_interrupted_tum(session.folder() / "odometry.tum");
  if (!odometry) return std::unexpected(odometry.error());
  if (const auto done = session.replace_trajectory(loops.correction.corrected(*odometry)); !done) return done;
  if (odometry->empty()) return {};
  return session.change_map(
      [&](PointTable& part) { move_points(part, "time", odometry->front().time, loops.correction, *odometry); });
}

}  // namespace pllit::app
