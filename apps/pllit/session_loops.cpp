#include "session_loops.hpp"

#include "pllit/io/csv.hpp"
#include "pllit/io/ply.hpp"
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
  auto map = read_ply(session.folder() / "map.ply");
  if (!map) return std::unexpected(map.error());
  if (!odometry->empty()) move_points(*map, "time", odometry->front().time, loops.correction, *odometry);
  return session.replace_map(*map);
}

}  // namespace pllit::app
