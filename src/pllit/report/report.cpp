#include "pllit/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <nlohmann/json.hpp>

#include "pllit/report/html.hpp"
#include "pllit/report/pictures.hpp"
#include "pllit/report/view3d.hpp"

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kStyle = R"(
:root{color-scheme:light dark}body{font:16px/1.5 system-ui,sans-serif;margin:0 auto;max-width:60rem;padding:1rem}
h1{font-size:1.5rem;margin:0}h2{font-size:1.15rem;margin:2rem 0 .5rem;border-bottom:1px solid #8886}
img,canvas{max-width:100%;height:auto;border-radius:4px}canvas{touch-action:none;cursor:grab}table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
td,th{padding:.25rem .5rem;text-align:left;border-bottom:1px solid #8884;vertical-align:top}.wide{overflow-x:auto}
.verdict{font-size:1.1rem;padding:.75rem 1rem;border-radius:6px;margin:1rem 0;border-left:6px solid}
.alarm{border-color:#c22;background:#c222}.calm{border-color:#282;background:#2822}.doubt{border-color:#c80;background:#c802}
.card{break-inside:avoid;border:1px solid #8886;border-radius:6px;padding:1rem;margin:1rem 0}.card h3{margin:0 0 .5rem}
.muted{opacity:.75;font-size:.9rem}.sign{border-bottom:1px solid #888;display:inline-block;min-width:14rem;height:1.5rem}
@media print{body{max-width:none;font-size:11pt}a{color:inherit}}
)";

std::string unit_text(IntensityUnit unit) {
  return unit == IntensityUnit::kelvin ? "K" : unit == IntensityUnit::count ? "counts" : "grey levels";
}

std::string row(std::string_view name, const std::string& value) {
  return std::format("<tr><th>{}</th><td>{}</td></tr>\n", escaped(name), value);
}

std::vector<Anomaly> alarms_of(const ReportContent& content) {
  std::vector<Anomaly> alarms;
  for (const Anomaly& anomaly : content.anomalies)
    if (anomaly.confirmed) alarms.push_back(anomaly);
  std::ranges::stable_sort(alarms, std::greater{}, &Anomaly::peak_sigmas);
  return alarms;
}

/// One sentence on top: what matters most.
std::string verdict(const ReportContent& content, std::size_t alarms, const Json& run) {
  const Json& health = run["health"];
  const int doubtful = health["degraded"].get<int>() + health["lost"].get<int>();
  std::string html;
  if (!content.has_images)
    html += "<p class=\"verdict doubt\">No thermal images were evaluated: this visit says nothing about heat.</p>\n";
  else if (alarms > 0)
    html += std::format("<p class=\"verdict alarm\"><b>{} {}</b> became abnormally hot.</p>\n", alarms,
                        alarms == 1 ? "place" : "places");
  else
    html += "<p class=\"verdict calm\">Nothing that was seen became abnormally hot.</p>\n";
  if (run["status"] != "done")
    html += std::format("<p class=\"verdict doubt\">The run did not end as planned: {}.</p>\n",
                        escaped(run["status"].get<std::string>()));
  if (doubtful > 0)
    html += std::format(
        "<p class=\"verdict doubt\">Localisation was in doubt in {} of {} frames; no heat was judged then.</p>\n",
        doubtful, run["frames"].get<int>());
  return html;
}

std::string corrected_text(const Radiometry& radiometry) {
  if (!radiometry.corrects()) return "apparent temperature; emissivity and reflections not corrected";
  std::string text = std::format("corrected for an emissivity of {:.2f} and surroundings of {:.1f} K",
                                 radiometry.emissivity, radiometry.reflected_K);
  if (radiometry.absorbed_per_m > 0.0)
    text += std::format(", and for air of {:.1f} K that absorbs {:.1f} % a metre", radiometry.air_K,
                        100.0 * radiometry.absorbed_per_m);
  return text + "; surfaces of another emissivity are off";
}

bool kelvin_from_counts(const ReportContent& content) {
  return content.unit == IntensityUnit::count && content.counts_per_kelvin > 0.0;
}

std::string change_text(const Anomaly& a, const ReportContent& content) {
  std::string text = std::format("{:.1f} {} on average, {:.1f} at its peak ({:.1f} and {:.1f} sigma)", a.mean_change,
                                 unit_text(content.unit), a.peak_change, a.mean_sigmas, a.peak_sigmas);
  if (kelvin_from_counts(content))
    text += std::format("; about {:.1f} and {:.1f} K", a.mean_change / content.counts_per_kelvin,
                        a.peak_change / content.counts_per_kelvin);
  return text;
}

std::string caveats(const Anomaly& a, const ReportContent& content) {
  const IntensityUnit unit = content.unit;
  std::vector<std::string> said;
  if (unit == IntensityUnit::grey)
    said.emplace_back("from video after gain control: a change is certain in sign, not in kelvin");
  if (kelvin_from_counts(content))
    said.push_back(std::format(
        "raw counts: differences in kelvin by the calibration given ({:.1f} counts a kelvin), no temperature",
        content.counts_per_kelvin));
  else if (unit == IntensityUnit::count)
    said.emplace_back("raw counts without calibration: no temperature");
  if (unit == IntensityUnit::kelvin) said.push_back(corrected_text(content.radiometry));
  if (a.views < 3) said.emplace_back("seen from few viewpoints: may be a reflection");
  if (a.voxels < 9) said.emplace_back("small: detected, its peak not measured");
  if (a.kind == AnomalyKind::new_hot) said.emplace_back("was not there before: judged by what stands around it");
  std::string text;
  for (const std::string& one : said) text += (text.empty() ? "" : "; ") + one;
  return text;
}

std::string card(const Anomaly& a, const ReportContent& content) {
  const double sigma_m = std::sqrt(a.covariance_m2.trace() / 3.0);
  std::string html =
      std::format("<section class=\"card\"><h3>Finding {}: {} ({})</h3>\n", a.id,
                  a.kind == AnomalyKind::heated ? "became hotter" : "hot object, not there before", name_of(a.state));
  if (const auto crop = content.crops.find(a.id); crop != content.crops.end())
    html += image_tag(thermogram(crop->second), std::format("Thermogram of finding {}", a.id));
  html += "<div class=\"wide\"><table>\n";
  html += row("place", std::format("x {:.2f}, y {:.2f}, z {:.2f} m (&plusmn; {:.2f} m in the map)", a.position_W.x(),
                                   a.position_W.y(), a.position_W.z(), sigma_m));
  html += row("size", std::format("{:.2f} &times; {:.2f} &times; {:.2f} m, {} voxels", a.extent_m.x(), a.extent_m.y(),
                                  a.extent_m.z(), a.voxels));
  html += row("above normal", change_text(a, content));
  if (const auto severity = severity_of(a, content.unit, content.severity))
    html += row("class", std::format("{}: {} ({})", escaped(severity->name), escaped(severity->action),
                                     escaped(content.severity.scheme)));
  html += row("first seen", utc_text(to_seconds(a.first_seen)));
  html += row("last seen", utc_text(to_seconds(a.last_seen)));
  html +=
      row("evidence", std::format("{} images from {} viewpoints, confidence {:.2f}", a.frames, a.views, a.confidence));
  html += row("caveats", escaped(caveats(a, content)));
  html +=
      "</table></div>\n<p class=\"muted\">Decision: <span class=\"sign\"></span> Reviewed by: <span class=\"sign\">"
      "</span></p></section>\n";
  return html;
}

std::string coverage(const ReportContent& content) {
  if (!content.has_images) return "";
  const double area_m2 = static_cast<double>(content.thermal_map.points.size()) * content.voxel_m * content.voxel_m;
  const std::vector<float>* images = find_field(content.thermal_map, "images");
  std::size_t known = 0;
  const auto known_after = static_cast<float>(content.known_after);
  if (images)
    known = static_cast<std::size_t>(std::ranges::count_if(*images, [&](float n) { return n >= known_after; }));
  const double share =
      content.thermal_map.points.empty() ? 0.0 : 100.0 * double(known) / double(content.thermal_map.points.size());
  return std::format(
      "<p>The camera saw about {:.0f} m&sup2; of surfaces; of {:.0f} % it saw enough to know what is normal there. "
      "What is dark in the plan "
      "was not seen and nothing is said about it.</p>\n",
      area_m2, share);
}

std::string health_section(const ReportContent& content, const Json& run) {
  const Json& health = run["health"];
  std::string html = "<h2>Localisation</h2><div class=\"wide\"><table>\n";
  html += row("frames", std::format("{} good, {} degraded, {} lost", health["good"].get<int>(),
                                    health["degraded"].get<int>(), health["lost"].get<int>()));
  html +=
      row("way", std::format("{:.1f} m in {:.0f} s", run["length_m"].get<double>(), run["duration_s"].get<double>()));
  if (run.contains("loops"))
    html += row("loops", std::format("{} closed, {} candidates refused", run["loops"]["accepted"].get<int>(),
                                     run["loops"]["rejected"].get<int>()));
  if (run.contains("ape") && run["ape"]["rmse"].is_number())
    html += row("error against the truth", std::format("{:.3f} m rms", run["ape"]["rmse"].get<double>()));
  html += "</table></div>\n" + health_plot(content.health);
  if (!content.doubts.empty()) {
    html += "<div class=\"wide\"><table><tr><th>from</th><th>for</th><th>state</th><th>why</th></tr>\n";
    for (const DoubtfulStretch& doubt : content.doubts)
      html += std::format("<tr><td>{}</td><td>{:.1f} s</td><td>{}</td><td>{}</td></tr>\n", utc_text(doubt.from_s),
                          doubt.to_s - doubt.from_s, escaped(doubt.state), escaped(doubt.reasons));
    html += "</table></div>\n";
  }
  return html;
}

std::string footer(const ReportContent& content, const Json& run) {
  std::string html = std::format(
      "<h2>How this was made</h2><p class=\"muted\">{}. Changes in {} against what each place showed before on this "
      "visit; 3 sigma, several neighbouring voxels, several images and half a second are needed for an alarm. "
      "Positions "
      "are in the session's map frame. A person qualified in thermography decides what a finding means.</p>\n",
      escaped(run.value("program", "")), unit_text(content.unit));
  for (const Json& source : run.value("sources", Json::array()))
    html += std::format("<p class=\"muted\">Recording: {}</p>\n", escaped(source.get<std::string>()));
  if (const std::string config = run.value("config", ""); !config.empty())
    html += std::format("<details><summary>Configuration</summary><pre class=\"wide\">{}</pre></details>\n",
                        escaped(config));
  return html;
}

}  // namespace

std::string report_html(const ReportContent& content, const Json& run) {
  const std::vector<Anomaly> alarms = alarms_of(content);
  std::string html = std::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</"
      "h1>\n",
      escaped(content.title), kStyle);
  if (!content.trajectory.empty())
    html += std::format("<p class=\"muted\">{} to {}</p>\n", utc_text(to_seconds(content.trajectory.front().time)),
                        utc_text(to_seconds(content.trajectory.back().time)));
  html += verdict(content, alarms.size(), run);
  const bool heat = !content.thermal_map.points.empty();
  const PointTable& map = heat ? content.thermal_map : content.map;
  html += "<h2>Plan</h2>\n" +
          image_tag(plan_of(map, content.trajectory, alarms), heat ? "Thermographic map from above" : "Map from above");
  html += coverage(content) + view3d(map, content.trajectory, alarms);
  if (!alarms.empty()) html += "<h2>Findings</h2>\n";
  for (const Anomaly& alarm : alarms) html += card(alarm, content);
  return html + health_section(content, run) + footer(content, run) + "</body></html>\n";
}

}  // namespace pllit
