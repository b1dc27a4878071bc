// What the thermographic stage tells while a session runs, and what it leaves behind.
#pragma once

#include <map>

#include "pllit/io/session.hpp"
#include "pllit/report/severity.hpp"
#include "pllit/slam/config.hpp"
#include "pllit/slam/loop_stage.hpp"
#include "pllit/slam/thermography.hpp"

namespace pllit::app {

/// Tells what becomes of anomalies as it happens.
class AlarmTeller {
 public:
  /// With `events` each change of an anomaly's state is a line of JSON on stdout.
  explicit AlarmTeller(bool events) : events_(events) {}

  /// To be called after each image. Alarms are logged, and anomalies.json is written anew, so that a kill loses none.
  Expected<void> tell(SessionWriter& session, const Thermography& thermography, Time time);

 private:
  bool events_;
  std::map<std::uint32_t, AnomalyState> told_;
};

/// What the stage has come to, where loop closing moved it.
struct SessionHeat {
  const Thermography& stage;
  std::vector<Anomaly> anomalies;
  PointTable map, points;
};

/// Writes anomalies.json, thermal_map.ply and anomalies.ply, and gives what they hold.
Expected<SessionHeat> write_heat(SessionWriter& session, const Thermography& thermography, const LoopResult& loops);

/// The table of severity that the configuration names, or the built-in one. To be read before a run starts: a mistake
/// in it must not be found after hours.
Expected<SeverityTable> severity_table(const Config& config);

/// Writes report.html from what the session holds and `run`, its run.json; `heat` is null where there was no camera.
Expected<void> write_report(SessionWriter& session, const nlohmann::ordered_json& run, const SessionHeat* heat,
                            const SeverityTable& severity);

}  // namespace pllit::app
