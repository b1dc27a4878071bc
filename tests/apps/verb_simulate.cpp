#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "run_program.hpp"

namespace pllit::test {
namespace {

using testing::HasSubstr;

class Simulate : public ProgramTest {};

TEST_F(Simulate, WritesABagThatDoctorAndRunAccept) {
  const auto made = run({"simulate", "room", "--duration", "5", "--seed", "2", "--set", "rig=inspection", "--set",
                         "image_rate=1", "--set", "images=both", "--out", path("room.bag")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, path("room.bag") + "\n");
  for (const char* beside : {"room.tum", "room.biases.csv", "room.scene.json"})
    EXPECT_TRUE(std::filesystem::exists(path(beside))) << beside;
  EXPECT_EQ(nlohmann::json::parse(read(path("room.scene.json")))["rig"], "inspection");

  const std::string counts = "input.image_topic=/thermal/image_raw";
  EXPECT_THAT(run({"run", path("room.bag"), "--config", "inspection", "--out", path("none")}).err,
              HasSubstr("2 topics could be the image"));
  const auto doctor = run({"doctor", path("room.bag"), "--config", "inspection", "--set", counts});
  EXPECT_EQ(doctor.exit_code, 0) << doctor.err;
  EXPECT_THAT(doctor.out, HasSubstr("/thermal/image_agc"));
  const std::vector<std::string> drawing{"doctor",    path("room.bag"), "--config", "inspection",
                                         "--overlay", path("o.png"),    "--set",    counts};
  EXPECT_THAT(run(drawing).out, HasSubstr("the LiDAR over"));
  EXPECT_TRUE(read(path("o.png")).starts_with("\x89PNG"));
  EXPECT_EQ(run(drawing).exit_code, 2) << "there is a picture already";
  const auto blind =
      run({"doctor", path("room.bag"), "--overlay", path("p.png"), "--set", "input.image_topic=/thermal/image_agc"});
  EXPECT_EQ(blind.exit_code, 2);
  EXPECT_THAT(blind.err + blind.out, HasSubstr("rig.camera"));

  const auto session = run({"run", path("room.bag"), "--config", "inspection", "--set", counts, "--truth",
                            path("room.tum"), "--out", path("session"), "--json"});
  ASSERT_EQ(session.exit_code, 0) << session.err;
  EXPECT_LT(nlohmann::json::parse(session.out)["ape"]["rmse"].get<double>(), 0.05);
}

TEST_F(Simulate, WritesFramesWithWhatTheyTrulyShow) {
  const std::vector<std::string> command{
      "simulate", "room",        "--duration", "5",       "--set",   "rig=inspection",
      "--set",    "images=both", "--set",      "scans=0", "--set",   "image_rate=2",
      "--frames", path("f"),     "--every",    "4",       "--truth", "depth,edges"};
  const auto made = run(command);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto index = nlohmann::json::parse(read(path("f/frames.json")));
  EXPECT_EQ(index["camera"]["width"], 640);
  ASSERT_EQ(index["frames"].size(), 3U);
  for (const auto& frame : index["frames"]) {
    EXPECT_LT(frame["seen_s"].get<double>(), frame["stamp_s"].get<double>());
    for (const char* key : {"grey", "counts", "depth"})
      EXPECT_TRUE(read(path("f/" + frame[key].get<std::string>())).starts_with("\x89PNG")) << key;
    const auto edges = nlohmann::json::parse(read(path("f/" + frame["edges"].get<std::string>())))["edges"];
    EXPECT_GT(edges.size(), 10U);
    EXPECT_GE(edges[0]["line_px"].size(), 2U);
    EXPECT_FALSE(frame.contains("temperature"));
  }
  EXPECT_EQ(run(command).exit_code, 2) << "the folder holds something";
  EXPECT_EQ(run({"simulate", "box_room", "--frames", path("g")}).exit_code, 2);
  EXPECT_EQ(run({"simulate", "room", "--set", "lost_share=0.1", "--frames", path("g")}).exit_code, 2);
}

TEST_F(Simulate, LeavesAReadableBagAfterCtrlC) {
  const std::string bag = path("cut.bag");
  const pid_t process = start({"simulate", "room", "--set", "images=none", "--out", bag});
  const bool running = waited_for(process, bag, 2'000'000);
  kill(process, SIGINT);
  const auto [exit_code, out, err] = finished(process);
  ASSERT_TRUE(running) << err;
  EXPECT_EQ(exit_code, 1);
  EXPECT_THAT(err, HasSubstr("interrupted; what was made so far is kept"));
  const auto doctor = run({"doctor", bag, "--config", "hilti2022"});
  EXPECT_NE(doctor.exit_code, 1) << doctor.err;
  EXPECT_THAT(doctor.out, testing::Not(HasSubstr("has no complete index")));
}

TEST_F(Simulate, SaysWhichScenesAndKeysThereAre) {
  const auto list = run({"simulate", "--list"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.out, testing::AllOf(HasSubstr("plant"), HasSubstr("H18"), HasSubstr("image_rate")));
  const auto unknown = run({"simulate", "romm", "--out", path("x.bag")});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, testing::AllOf(HasSubstr("did you mean room"), HasSubstr("corridor")));
  EXPECT_EQ(run({"simulate", "room"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("x.bag")));
}

TEST_F(Simulate, NamesTheFileThatARowMisses) {
  const auto missing = run({"simulate", "room", "--set", "motion=nowhere.tum", "--out", path("x.bag")});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, testing::AllOf(HasSubstr("nowhere.tum"), HasSubstr("PLLIT_DATA")));
}

TEST_F(Simulate, NeverReplacesABagUnasked) {
  write("old.bag", "precious");
  const auto refused = run({"simulate", "room", "--duration", "3", "--out", path("old.bag")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(read(path("old.bag")), "precious");
}

}  // namespace
}  // namespace pllit::test
