#include "findings.hpp"

#include <format>

#include "pllit/eval/evaluate.hpp"
#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/tum.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;

/// F.tum for F.scene.json; scene.json stands beside truth.tum in a session.
fs::path truth_of(const fs::path& scene, const fs::path& session) {
  if (fs::exists(session / "truth.tum")) return session / "truth.tum";
  const fs::path name = scene.stem().stem();
  return scene.parent_path() / (name == "scene" ? fs::path("truth.tum") : fs::path(name.string() + ".tum"));
}

Expected<SE3> world_alignment(const fs::path& scene, const fs::path& session, Alignment alignment) {
  const auto truth = read_tum(truth_of(scene, session));
  if (!truth) return std::unexpected(truth.error());
  const auto estimate = read_interrupted_tum(session / "trajectory.tum");
  if (!estimate) return std::unexpected(estimate.error());
  const auto scores = evaluate(*truth, *estimate, {.alignment = alignment, .rpe_deltas_m = {}});
  if (!scores) return std::unexpected(scores.error());
  return scores->T_W_V;
}

}  // namespace

Expected<FindingScores> score_session_findings(const fs::path& scene, const fs::path& session, Alignment alignment) {
  const auto text = read_file(scene);
  if (!text) return std::unexpected(text.error());
  const auto json = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (json.is_discarded()) return input_error(std::format("{}: is not JSON", scene.string()));
  const auto objects = objects_of_scene(json);
  if (!objects) return in_context(scene.string(), objects.error());
  const auto anomalies = read_anomalies(session / "anomalies.json");
  if (!anomalies) return std::unexpected(anomalies.error());
  const auto T_W_V = world_alignment(scene, session, alignment);
  if (!T_W_V) return std::unexpected(T_W_V.error());
  return score_findings(*anomalies, *objects, *T_W_V);
}

std::string findings_text(const nlohmann::ordered_json& findings) {
  std::string text = std::format("findings    {} of {} found, {} false alarms", findings["found"].get<int>(),
                                 findings["objects"].get<int>(), findings["false_alarms"].get<int>());
  if (findings["position_m"]["max"].is_number())
    text += std::format("; position off by {:.3f} m (median {:.3f}), alarm after {:.2f} s at most",
                        findings["position_m"]["max"].get<double>(), findings["position_m"]["median"].get<double>(),
                        findings["delay_s"]["max"].get<double>());
  return text + "\n";
}

}  // namespace pllit::app
