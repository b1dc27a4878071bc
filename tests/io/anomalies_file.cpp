#include "pllit/io/anomalies_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pllit/io/file.hpp"
#include "support/temporary_folder.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;

Anomaly example() {
  Anomaly anomaly{.id = 3, .kind = AnomalyKind::new_hot, .state = AnomalyState::cooling};
  anomaly.position_W = {1.25, -2.5, 0.875};
  anomaly.covariance_m2 << 4e-4, 1e-5, 0.0, 1e-5, 5e-4, 0.0, 0.0, 0.0, 6e-4;
  anomaly.extent_m = {0.2, 0.25, 0.3};
  anomaly.mean_change = 41.5;
  anomaly.peak_change = 66.25;
  anomaly.mean_sigmas = 8.5;
  anomaly.peak_sigmas = 14.0;
  anomaly.first_seen = time_from_parts(1'700'000'041, 250'000'000);
  anomaly.confirmed = time_from_parts(1'700'000'041, 950'000'000);
  anomaly.last_seen = time_from_parts(1'700'000'050, 0);
  anomaly.voxels = 23;
  anomaly.frames = 77;
  anomaly.views = 5;
  anomaly.confidence = 0.75;
  anomaly.crop = ImageCrop{.time = anomaly.last_seen, .left = 100, .top = 50, .width = 60, .height = 40};
  return anomaly;
}

TEST(AnomaliesFile, GivesBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  Anomaly bare{.id = 1};
  const std::vector<Anomaly> written{bare, example()};
  ASSERT_TRUE(write_file(folder.path() / "anomalies.json", anomalies_json(written, IntensityUnit::grey).dump()));
  const auto read = read_anomalies(folder.path() / "anomalies.json");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2u);
  EXPECT_FALSE((*read)[0].confirmed);
  EXPECT_FALSE((*read)[0].crop);
  EXPECT_EQ(anomaly_json((*read)[1]), anomaly_json(example()));
  EXPECT_EQ((*read)[1].confirmed, example().confirmed);
}

TEST(AnomaliesFile, SaysItsSchemaAndUnitAndClaimsNoTemperatureOfGreys) {
  const auto json = anomalies_json(std::vector{example()}, IntensityUnit::grey);
  EXPECT_EQ(json.begin().key(), "schema_version");
  EXPECT_EQ(json["unit"], "grey");
  const std::string text = json.dump();
  for (const char* word : {"celsius", "kelvin", "_K", "temperature"}) EXPECT_THAT(text, Not(HasSubstr(word)));
}

TEST(AnomaliesFile, RefusesWhatIsNoneWithTheReason) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "anomalies.json";
  const auto message = [&](const std::string& text) {
    EXPECT_TRUE(write_file(path, text));
    const auto read = read_anomalies(path);
    return read ? std::string("accepted") : read.error().message;
  };
  EXPECT_THAT(message("{"), HasSubstr("is not JSON"));
  EXPECT_THAT(message("[1, 2]"), HasSubstr("schema 1"));
  EXPECT_THAT(message(R"({"schema_version": 7, "anomalies": []})"), HasSubstr("schema 1"));
  auto json = anomalies_json(std::vector{example()}, IntensityUnit::grey);
  json["anomalies"][0]["kind"] = "cold";
  EXPECT_THAT(message(json.dump()), HasSubstr("finding 1: \"cold\""));
  json["anomalies"][0].erase("kind");
  EXPECT_THAT(message(json.dump()), HasSubstr("kind"));
  EXPECT_THAT(read_anomalies(folder.path() / "none.json").error().message, HasSubstr("none.json"));
}

}  // namespace
}  // namespace pllit
