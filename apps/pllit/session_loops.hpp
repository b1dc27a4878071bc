// What loop closing leaves in a session.
#pragma once

#include "pllit/io/session.hpp"
#include "pllit/slam/loop_stage.hpp"

namespace pllit::app {

/// Writes loops.csv, a row for each candidate, and where loops were closed the corrected trajectory and the map moved
/// with it. odometry.tum stays.
Expected<void> write_loops(SessionWriter& session, const LoopResult& loops);

}  // namespace pllit::app
