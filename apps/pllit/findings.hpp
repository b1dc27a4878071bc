// A session's anomalies against the truth.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "pllit/eval/align.hpp"
#include "pllit/eval/findings.hpp"

namespace pllit::app {

/// Scores SESSION/anomalies.json against a scene. The world of the session is aligned with that of the truth by its
/// trajectory: SESSION/truth.tum, or else F.tum beside F.scene.json.
Expected<FindingScores> score_session_findings(const std::filesystem::path& scene, const std::filesystem::path& session,
                                               Alignment alignment);
/// For people; `findings` as findings_json() makes it.
std::string findings_text(const nlohmann::ordered_json& findings);

}  // namespace pllit::app
