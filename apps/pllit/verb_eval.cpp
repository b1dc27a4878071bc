// pllit eval: scores an estimated trajectory against the true one.
#include <cmath>
#include <cstdio>
#include <format>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "findings.hpp"
#include "pllit/eval/evaluate.hpp"
#include "pllit/eval/scores_json.hpp"
#include "pllit/io/csv.hpp"
#include "pllit/io/tum.hpp"
#include "program.hpp"

namespace pllit::app {
namespace {

struct EvalOptions {
  std::string truth, estimate, scene, errors;
  EvaluationConfig evaluation;
  bool json = false;
};

Expected<Scores> scores_of(const EvalOptions& options) {
  const auto truth = read_tum(options.truth);
  if (!truth) return std::unexpected(truth.error());
  const auto estimate = read_tum(options.estimate);
  if (!estimate) return std::unexpected(estimate.error());
  return evaluate(*truth, *estimate, options.evaluation);
}

std::string text_of(const Scores& scores) {
  const Statistics &m = scores.ape.translation_m, &deg = scores.ape.rotation_deg;
  std::string text = std::format("{} poses matched over {:.1f} m\n\n", scores.matched, scores.length_m);
  text += std::format("{:<12}{:>10}{:>10}{:>10}\n", "APE", "rmse", "median", "max");
  text += std::format("{:<12}{:>10.4f}{:>10.4f}{:>10.4f}\n", "  metres", m.rmse, m.median, m.max);
  text += std::format("{:<12}{:>10.4f}{:>10.4f}{:>10.4f}\n", "  degrees", deg.rmse, deg.median, deg.max);
  text += std::format("\n{:<12}{:>10}{:>10}{:>10}{:>10}\n", "RPE over", "rmse m", "percent", "yaw deg", "pairs");
  for (const RelativeError& error : scores.rpe) {
    const std::string name = std::format("  {} m", error.delta_m);
    text += error.pairs == 0 ? std::format("{:<12}{:>10}\n", name, "the path is too short")
                             : std::format("{:<12}{:>10.4f}{:>10.3f}{:>10.3f}{:>10}\n", name, error.rmse_m,
                                           error.percent, error.yaw_deg, error.pairs);
  }
  return text;
}

std::string json_of(const Scores& scores) {
  nlohmann::ordered_json json = {{"schema_version", kSchemaVersion}};
  json.update(scores_json(scores));
  return json.dump(2) + "\n";
}

/// Every error on its own: a row for each pose (measure "ape") and each pair of poses ("rpe").
Expected<void> write_errors(const std::string& path, const Scores& scores) {
  const std::vector<std::string> columns{"measure", "delta_m", "distance_m", "error_m", "yaw_deg", "rotation_deg"};
  std::vector<std::vector<CsvCell>> rows;
  for (const ErrorSample& e : scores.ape.samples)
    rows.push_back({"ape", std::nan(""), e.distance_m, e.error_W_m.norm(), e.yaw_deg, e.rotation_deg});
  for (const RelativeError& error : scores.rpe)
    for (const RelativeSample& e : error.samples)
      rows.push_back({"rpe", error.delta_m, e.distance_m, e.error_m, e.yaw_deg, e.rotation_deg});
  auto file = CsvWriter::create(path, columns);
  if (!file) return std::unexpected(file.error());
  for (const auto& row : rows)
    if (auto written = file->append(row); !written) return written;
  return file->close();
}

/// With --findings the one path that is given is a session.
ExitCode run_findings(const EvalOptions& options) {
  if (!options.estimate.empty()) return report(input_error("eval --findings takes one session, not two paths").error());
  const auto scores = score_session_findings(options.scene, options.truth, options.evaluation.alignment);
  if (!scores) return report(scores.error());
  nlohmann::ordered_json json = {{"schema_version", kSchemaVersion}};
  json["findings"] = findings_json(*scores);
  std::fputs((options.json ? json.dump(2) + "\n" : findings_text(json["findings"])).c_str(), stdout);
  return ExitCode::done;
}

ExitCode run(const EvalOptions& options) {
  if (!options.scene.empty()) return run_findings(options);
  const auto scores = scores_of(options);
  if (!scores) return report(scores.error());
  if (!options.errors.empty())
    if (const auto written = write_errors(options.errors, *scores); !written) return report(written.error());
  std::fputs((options.json ? json_of(*scores) : text_of(*scores)).c_str(), stdout);
  return ExitCode::done;
}

}  // namespace

Verb add_eval(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("eval", "Score an estimated trajectory, or findings, against the truth");
  const auto options = std::make_shared<EvalOptions>();
  verb->add_option("truth", options->truth, "True trajectory; with --findings the session")
      ->type_name("TRUTH.tum|SESSION")
      ->required();
  verb->add_option("estimate", options->estimate, "Estimated trajectory")->type_name("ESTIMATE.tum");
  verb->parse_complete_callback([options] {
    if (options->estimate.empty() && options->scene.empty()) throw CLI::RequiredError("estimate");
  });
  verb->add_option("--findings", options->scene, "Score a session's anomalies against what the simulator put there")
      ->type_name("F.scene.json");
  const std::map<std::string, Alignment> alignments{
      {"se3", Alignment::se3}, {"yaw", Alignment::yaw}, {"none", Alignment::none}};
  verb->add_option("--align", options->evaluation.alignment,
                   "How the estimate is moved onto the truth first: se3 (default), yaw (keeps its vertical) or none")
      ->transform(CLI::CheckedTransformer(alignments).description(""))
      ->type_name("se3|yaw|none");
  verb->add_option("--rpe", options->evaluation.rpe_deltas_m,
                   "Distances over which the drift is measured (default 10 100)")
      ->type_name("METRES");
  verb->add_option("--errors", options->errors, "Also write each single error, for plots")->type_name("F.csv");
  verb->add_flag("--json", options->json, "Print JSON");
  verb->footer(
      "Examples:\n"
      "  pllit eval truth.tum results/latest/trajectory.tum\n"
      "  pllit eval truth.tum estimate.tum --align yaw --rpe 10 50 100 --json\n"
      "  pllit eval truth.tum estimate.tum --errors errors.csv\n"
      "  pllit eval --findings a1.scene.json results/latest");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
