#include "pllit/eval/scores_json.hpp"

#include <nlohmann/json.hpp>

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Alignment alignment) {
  switch (alignment) {
    case Alignment::se3:
      return "se3";
    case Alignment::yaw:
      return "yaw";
    case Alignment::none:
      break;
  }
  return "none";
}

Json statistics_json(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"std", s.std}, {"max", s.max}};
}

Json relative_json(const RelativeError& error) {
  const auto figure = [&](double value) { return error.pairs == 0 ? Json(nullptr) : Json(value); };
  return {{"delta_m", error.delta_m},
          {"rmse", figure(error.rmse_m)},
          {"percent", figure(error.percent)},
          {"yaw_deg", figure(error.yaw_deg)},
          {"rotation_deg", figure(error.rotation_deg)},
          {"pairs", error.pairs}};
}

}  // namespace

Json scores_json(const Scores& scores) {
  Json ape = statistics_json(scores.ape.translation_m);
  ape["rotation_deg"] = statistics_json(scores.ape.rotation_deg);
  Json rpe = Json::array();
  for (const RelativeError& error : scores.rpe) rpe.push_back(relative_json(error));
  return {{"matched", scores.matched},
          {"length_m", scores.length_m},
          {"align", name_of(scores.alignment)},
          {"ape", std::move(ape)},
          {"rpe", std::move(rpe)}};
}

}  // namespace pllit
