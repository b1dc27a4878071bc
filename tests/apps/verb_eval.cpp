#include <cmath>
#include <format>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/csv.hpp"
#include "run_program.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class EvalVerb : public test::ProgramTest {
 protected:
  /// A walk around a 20 m circle in 40 s, ten poses a second, each position passed through `change`.
  std::string walk(const std::string& name, const std::function<std::array<double, 3>(double, double)>& change) const {
    std::string text;
    for (int i = 0; i < 400; ++i) {
      const double angle = 2.0 * M_PI * i / 400.0;
      const auto [x, y, z] = change(20.0 * std::cos(angle), 20.0 * std::sin(angle));
      text += std::format("{:.6f} {:.9f} {:.9f} {:.9f} 0 0 0 1\n", 1000.0 + 0.1 * i, x, y, z);
    }
    return write(name, text);
  }
  std::string truth() const {
    return walk("truth.tum", [](double x, double y) { return std::array{x, y, 0.0}; });
  }
};

TEST_F(EvalVerb, GivesZeroForTheTruthItself) {
  const auto [exit_code, out, err] = run({"eval", truth(), truth(), "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  EXPECT_THAT(err, IsEmpty());
  const auto json = nlohmann::ordered_json::parse(out);
  EXPECT_EQ(json.begin().key(), "schema_version");
  EXPECT_EQ(json["matched"], 400);
  EXPECT_NEAR(json["ape"]["rmse"].get<double>(), 0.0, 1e-8);
  ASSERT_EQ(json["rpe"].size(), 2u);
  EXPECT_EQ(json["rpe"][0]["delta_m"], 10.0);
  EXPECT_NEAR(json["rpe"][0]["rmse"].get<double>(), 0.0, 1e-8);
}

TEST_F(EvalVerb, WritesEachErrorThatItsFiguresAreMadeOf) {
  const std::string longer = walk("longer.tum", [](double x, double y) { return std::array{1.01 * x, 1.01 * y, 0.0}; });
  const std::string file = write("errors.csv", "of an earlier call\n");
  const auto [exit_code, out, err] = run({"eval", truth(), longer, "--rpe", "5", "--errors", file, "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  const auto table = read_csv(file);
  ASSERT_TRUE(table) << table.error().message;
  const auto json = nlohmann::json::parse(out);
  std::map<std::string, std::vector<double>> squares;
  for (const auto& row : table->rows) squares[row[0]].push_back(std::pow(std::stod(row[3]), 2));
  const auto rmse = [&](const std::string& measure) {
    const auto& all = squares[measure];
    return std::sqrt(std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size()));
  };
  EXPECT_EQ(squares["ape"].size(), json["matched"]);
  EXPECT_NEAR(rmse("ape"), json["ape"]["rmse"].get<double>(), 1e-6);
  EXPECT_EQ(squares["rpe"].size(), json["rpe"][0]["pairs"]);
  EXPECT_NEAR(rmse("rpe"), json["rpe"][0]["rmse"].get<double>(), 1e-6);
}

TEST_F(EvalVerb, AlignsAsAsked) {
  const std::string shifted = walk("shifted.tum", [](double x, double y) { return std::array{x + 3.0, y, 4.0}; });
  const auto rmse = [&](const std::string& align) {
    const auto outcome = run({"eval", truth(), shifted, "--align", align, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["ape"]["rmse"].get<double>();
  };
  EXPECT_NEAR(rmse("none"), 5.0, 1e-6);
  EXPECT_NEAR(rmse("se3"), 0.0, 1e-6);
  EXPECT_NEAR(rmse("yaw"), 0.0, 1e-6);
}

TEST_F(EvalVerb, MeasuresDriftOverTheDistancesGiven) {
  const std::string longer = walk("longer.tum", [](double x, double y) { return std::array{1.01 * x, 1.01 * y, 0.0}; });
  const auto [exit_code, out, err] = run({"eval", truth(), longer, "--rpe", "5", "20", "--rpe", "1000", "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  const auto rpe = nlohmann::json::parse(out)["rpe"];
  ASSERT_EQ(rpe.size(), 3u);
  EXPECT_NEAR(rpe[0]["percent"].get<double>(), 1.0, 0.05);
  EXPECT_EQ(rpe[1]["delta_m"], 20.0);
  EXPECT_TRUE(rpe[2]["rmse"].is_null()) << "the walk is shorter than that";
}

TEST_F(EvalVerb, PrintsATableForPeople) {
  const auto [exit_code, out, err] = run({"eval", truth(), truth(), "--rpe", "10", "1000"});
  EXPECT_EQ(exit_code, 0) << err;
  EXPECT_THAT(out, HasSubstr("400 poses matched over 125."));
  EXPECT_THAT(out, HasSubstr("APE"));
  EXPECT_THAT(out, HasSubstr("the path is too short"));
}

/// A session's anomalies in the world of the walk turned by a right angle, one on the object and one off it.
class EvalFindings : public EvalVerb {
 protected:
  std::string session() const {
    std::filesystem::create_directory(path("session"));
    truth();
    walk("session/trajectory.tum", [](double x, double y) { return std::array{-y, x, 0.0}; });
    Anomaly found{.id = 1, .state = AnomalyState::confirmed};
    found.position_W = {-4.0, 3.04, 1.0};
    found.confirmed = Time(std::chrono::milliseconds(1'025'700));
    Anomaly false_alarm = found;
    false_alarm.id = 2;
    false_alarm.position_W = {9.0, 0.0, 1.0};
    write("session/anomalies.json", anomalies_json(std::vector{found, false_alarm}, IntensityUnit::grey).dump());
    return path("session");
  }
  std::string scene() const {
    return write("truth.scene.json", R"({"start_s": 1000.0, "objects": [{"name": "kettle", "finding": true,
      "begins_s": 20.0, "centroid_W": [3.0, 4.0, 1.0], "first_seen_s": 25.0}]})");
  }
};

TEST_F(EvalFindings, AreScoredAgainstTheScene) {
  const auto [exit_code, out, err] = run({"eval", "--findings", scene(), session(), "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  const auto json = nlohmann::ordered_json::parse(out);
  EXPECT_EQ(json.begin().key(), "schema_version");
  EXPECT_EQ(json["findings"]["objects"], 1);
  EXPECT_EQ(json["findings"]["found"], 1);
  EXPECT_EQ(json["findings"]["false_alarms"], 1);
  EXPECT_NEAR(json["findings"]["position_m"]["max"].get<double>(), 0.04, 1e-3);
  EXPECT_NEAR(json["findings"]["delay_s"]["max"].get<double>(), 0.7, 1e-3);
  EXPECT_THAT(run({"eval", "--findings", scene(), session()}).out, HasSubstr("1 of 1 found, 1 false alarms"));
}

TEST_F(EvalFindings, NeedOneSessionThatHoldsAnomalies) {
  const auto message = [&](const std::vector<std::string>& arguments) {
    const auto outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.err;
  };
  EXPECT_THAT(message({"eval", "--findings", scene(), session(), session()}), HasSubstr("one session"));
  EXPECT_THAT(message({"eval", truth()}), HasSubstr("estimate is required"));
  const std::string folder = session();
  std::filesystem::remove(folder + "/anomalies.json");
  EXPECT_THAT(message({"eval", "--findings", scene(), folder}), HasSubstr("anomalies.json"));
  EXPECT_THAT(message({"eval", "--findings", truth(), folder}), HasSubstr("is not JSON"));
}

TEST_F(EvalVerb, RefusesWrongInputWithExitCodeTwo) {
  const std::string broken = write("broken.tum", "1.0 2.0 three\n");
  const std::string later = write("later.tum", "9000000 0 0 0 0 0 0 1\n9000001 1 0 0 0 0 0 1\n9000002 1 1 0 0 0 0 1\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"eval", truth(), path("absent.tum")}, "absent.tum"},
      {{"eval", truth(), broken}, "broken.tum"},
      {{"eval", truth(), later}, ""},
      {{"eval", truth(), truth(), "--align", "sim3"}, "sim3"},
      {{"eval", truth(), truth(), "--rpe", "-5"}, "-5"}};
  for (const auto& [arguments, message] : cases) {
    const auto [exit_code, out, err] = run(arguments);
    EXPECT_EQ(exit_code, 2) << err;
    EXPECT_THAT(out, IsEmpty());
    EXPECT_THAT(err, HasSubstr(message));
    EXPECT_NE(err, "");
  }
}

}  // namespace
}  // namespace pllit
