// pllit simulate: a simulated recording as an ordinary ROS 1 bag, with the truth beside it.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <format>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stop_token>
#include <utility>

#include "frame_folder.hpp"
#include "interrupt.hpp"
#include "pllit/io/bag_writer.hpp"
#include "pllit/io/csv.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/sim/sequences.hpp"
#include "program.hpp"
#include "progress_bar.hpp"
#include "source.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::string scene, out, frames;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::vector<std::string> settings;
  std::string cloud_time = "driver";
  int jpeg = 0, every = 1;
  std::vector<std::string> truth;
  bool list = false, json = false, overwrite = false;
};

/// How a rig's drivers name and lay out what they publish.
struct Topics {
  std::string imu, lidar, grey, counts;
  bool livox;
  PointCloud2Layout cloud;
};

Topics topics_of(const std::string& rig, const std::string& cloud_time) {
  using Field = PointCloud2Layout::TimeField;
  Topics topics{"/imu/data", "/points", "/camera/image_raw", "/camera/counts", false, {}};
  if (rig == "hilti2022")
    topics = {
        "/alphasense/imu", "/hesai/pandar", "/alphasense/cam0/image_raw", "", false, {.time_field = Field::timestamp}};
  if (rig == "ntu4dradlm")
    topics = {"/livox/imu", "/livox/lidar", "/thermal_cam/thermal_image", "/thermal_cam/counts", true, {}};
  if (rig == "inspection") topics = {"/imu/data", "/livox/lidar", "/thermal/image_agc", "/thermal/image_raw", true, {}};
  if (cloud_time == "seconds") topics.cloud = {.time_field = Field::time, .time_unit = TimeUnit::seconds};
  if (cloud_time == "microseconds") topics.cloud = {.time_field = Field::time, .time_unit = TimeUnit::microseconds};
  return topics;
}

class Recorder {
 public:
  Recorder(BagWriter& bag, Topics topics, int jpeg) : bag_(bag), topics_(std::move(topics)), jpeg_(jpeg) {}

  Expected<void> write(const SensorEvent& event) {
    if (const auto* imu = std::get_if<ImuSample>(&event.data)) return bag_.write_imu(topics_.imu, event.received, *imu);
    if (const auto* scan = std::get_if<LidarScan>(&event.data))
      return topics_.livox ? bag_.write_livox_scan(topics_.lidar, event.received, *scan)
                           : bag_.write_scan(topics_.lidar, event.received, *scan, topics_.cloud);
    return write_image(event.received, std::get<CameraFrame>(event.data));
  }

 private:
  Expected<void> write_image(Time received, const CameraFrame& frame) {
    const bool counts = frame.counts.type() == CV_16UC1;
    const std::string& topic = counts ? topics_.counts : topics_.grey;
    if (counts || jpeg_ == 0) return bag_.write_image(topic, received, frame);
    std::vector<std::uint8_t> file;
    cv::imencode(".jpg", frame.counts, file, {cv::IMWRITE_JPEG_QUALITY, jpeg_});
    return bag_.write(
        topic + "/compressed", kCompressedImageType, received,
        encode_compressed_image(frame.time, "mono8; jpeg compressed ", std::as_bytes(std::span(file)), "camera"));
  }

  BagWriter& bag_;
  Topics topics_;
  int jpeg_;
};

std::string address_of(const SimulateOptions& options) {
  std::string address = options.scene.starts_with("sim:") ? options.scene : "sim:" + options.scene;
  const auto add = [&](const std::string& assignment) { address += (address.contains('?') ? "&" : "?") + assignment; };
  if (options.seed) add(std::format("seed={}", *options.seed));
  if (options.duration_s) add(std::format("duration={}", *options.duration_s));
  for (const std::string& setting : options.settings) add(setting);
  return address;
}

Expected<void> write_biases(const fs::path& file, const std::vector<StampedImuBias>& biases) {
  const std::vector<std::string> columns{"t_s",          "gyro_x_rps",   "gyro_y_rps",  "gyro_z_rps",
                                         "accel_x_mps2", "accel_y_mps2", "accel_z_mps2"};
  auto csv = CsvWriter::create(file, columns);
  if (!csv) return std::unexpected(csv.error());
  for (std::size_t i = 0; i < biases.size(); i += 100) {  // they walk slowly
    const auto& [time, bias] = biases[i];
    std::vector<CsvCell> row{std::format("{:.9f}", to_seconds(time.time_since_epoch()))};
    for (const Vector3d& v : {bias.gyro_rps, bias.accel_mps2})
      for (const double component : v) row.emplace_back(component);
    if (auto done = csv->append(row); !done) return done;
  }
  return csv->close();
}

/// What a simulation is written to: a bag, a folder of frames, or both.
struct Outputs {
  std::optional<BagWriter> bag;
  std::optional<Recorder> recorder;
  std::optional<FrameFolder> frames;

  Expected<void> write(const SensorEvent& event, Simulation& simulation) {
    if (frames)
      if (auto done = frames->write(event, simulation); !done) return done;
    return recorder ? recorder->write(event) : Expected<void>{};
  }
};

/// Events until the end or a signal.
Expected<void> record(Simulation& simulation, Outputs& outputs, const std::stop_token& stop) {
  ProgressBar bar("messages", spdlog::should_log(spdlog::level::info));
  for (long count = 1; !stop.stop_requested(); ++count) {
    const auto event = simulation.next();
    if (!event) return std::unexpected(event.error());
    if (!*event) return {};
    if (auto done = outputs.write(**event, simulation); !done) return done;
    bar.show(simulation.progress(), count);
  }
  return failure("interrupted; what was made so far is kept, without a scene file");
}

fs::path beside(const SimulateOptions& options, const char* extension) {
  return fs::path(options.out).replace_extension(extension);
}

Expected<void> open_outputs(const SimulateOptions& options, const Simulation& simulation, Outputs& outputs) {
  if (!options.frames.empty()) {
    const auto wanted = [&](const char* what) { return std::ranges::contains(options.truth, what); };
    const FrameChoice choice{.every = options.every,
                             .depth = wanted("depth"),
                             .temperature = wanted("temperature"),
                             .edges = wanted("edges")};
    auto frames = FrameFolder::create(options.frames, choice, options.overwrite, simulation);
    if (!frames) return std::unexpected(frames.error());
    outputs.frames.emplace(std::move(*frames));
  }
  if (options.out.empty()) return {};
  auto bag = BagWriter::create(options.out);
  if (!bag) return std::unexpected(bag.error());
  outputs.bag.emplace(std::move(*bag));
  outputs.recorder.emplace(*outputs.bag, topics_of(simulation.rig_name(), options.cloud_time), options.jpeg);
  if (auto done = write_tum(beside(options, ".tum"), simulation.truth()); !done) return done;
  return write_biases(beside(options, ".biases.csv"), simulation.true_biases());
}

Expected<ExitCode> simulate(const SimulateOptions& options) {
  if (!options.out.empty() && fs::exists(options.out) && !options.overwrite)
    return input_error(std::format("'{}' exists; give another name with --out, or --overwrite", options.out));
  const std::string address = address_of(options);
  const Interrupt interrupt;  // before the simulation starts threads
  auto simulation = open_simulation_with_files(address, Images::wanted);
  if (!simulation) return std::unexpected(simulation.error());
  Outputs outputs;
  if (auto opened = open_outputs(options, *simulation, outputs); !opened) return std::unexpected(opened.error());
  const auto recorded = record(*simulation, outputs, interrupt.token());
  if (outputs.frames)
    if (auto closed = outputs.frames->close(*simulation, address); !closed) return std::unexpected(closed.error());
  if (outputs.bag)
    if (auto closed = outputs.bag->close(); !closed) return std::unexpected(closed.error());
  if (!recorded) return std::unexpected(recorded.error());
  const fs::path scene = options.out.empty() ? fs::path(options.frames) / "scene.json" : beside(options, ".scene.json");
  if (auto done = replace_file(scene, scene_json(simulation->scene_truth(), address).dump(2) + "\n"); !done)
    return std::unexpected(done.error());
  std::puts((options.out.empty() ? options.frames : options.out).c_str());
  return ExitCode::done;
}

void print_list() {
  std::puts("Scenes:");
  for (const std::string& scene : scene_names()) std::printf("  %s\n", scene.c_str());
  std::puts("Rows of the table of sequences:");
  for (const Sequence& row : sequences()) std::printf("  %-4s %s\n", row.name.c_str(), row.source.c_str());
  std::puts("Keys (b: boxes only, w: all but boxes):");
  for (const SimKey& key : sim_keys())
    std::printf("  %c %-12s %s\n",
                key.scenes == SimKey::For::all     ? ' '
                : key.scenes == SimKey::For::boxes ? 'b'
                                                   : 'w',
                std::string(key.name).c_str(), key.wants.c_str());
}

void print_list_json() {
  nlohmann::ordered_json json{{"schema_version", kSchemaVersion}, {"scenes", scene_names()}};
  for (const Sequence& row : sequences())
    json["rows"].push_back({{"name", row.name},
                            {"source", row.source},
                            {"config", row.config},
                            {"tier", kTierNames[static_cast<std::size_t>(row.tier)]}});
  for (const SimKey& key : sim_keys()) json["keys"].push_back({{"name", key.name}, {"wants", key.wants}});
  std::puts(json.dump(2).c_str());
}

ExitCode run(const SimulateOptions& options) {
  if (options.list) {
    options.json ? print_list_json() : print_list();
    return ExitCode::done;
  }
  if (options.scene.empty() || (options.out.empty() && options.frames.empty()))
    return report({Error::Kind::input,
                   "simulate needs a SCENE and --out F.bag or --frames DIR; --list shows scenes, rows and keys"});
  const auto code = simulate(options);
  return code ? *code : report(code.error());
}

}  // namespace

Verb add_simulate(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("simulate", "Write a simulated recording as a ROS 1 bag, with the truth beside it");
  const auto options = std::make_shared<SimulateOptions>();
  verb->add_option("scene", options->scene, "Scene, row of the table of sequences, or sim:SCENE?key=value&...")
      ->type_name("SCENE");
  verb->add_option("--out", options->out, "Bag to write; F.tum, F.biases.csv and F.scene.json come beside it")
      ->type_name("F.bag");
  verb->add_option("--seed", options->seed, "Of everything that is drawn")->type_name("N");
  verb->add_option("--duration", options->duration_s, "Seconds (default: the whole motion)")->type_name("S");
  verb->add_option("--set", options->settings, "A key of the simulation, e.g. light=night")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
  verb->add_option("--cloud-time", options->cloud_time,
                   "Of PointCloud2: as the sensor's driver, or float32 `time` in seconds or microseconds")
      ->check(CLI::IsMember({"driver", "seconds", "microseconds"}).description(""))
      ->type_name("driver|seconds|microseconds");
  verb->add_option("--jpeg", options->jpeg, "Compress 8-bit images with this quality")
      ->check(CLI::Range(1, 100).description(""))
      ->type_name("1..100");
  verb->add_option("--frames", options->frames, "Folder to write images to as PNG; frames.json is its index")
      ->type_name("DIR");
  verb->add_option("--every", options->every, "With --frames: one image in N")
      ->check(CLI::Range(1, 1000000).description(""))
      ->type_name("N");
  verb->add_option("--truth", options->truth, "With --frames: what each image truly shows")
      ->delimiter(',')
      ->check(CLI::IsMember({"depth", "temperature", "edges"}).description(""))
      ->type_name("depth,temperature,edges");
  verb->add_flag("--overwrite", options->overwrite,
                 "Replace the bag if it exists, write into a folder that is not empty");
  verb->add_flag("--list", options->list, "Show scenes, rows and keys");
  verb->add_flag("--json", options->json, "With --list: as JSON");
  verb->footer(
      "Examples:\n"
      "  pllit simulate plant --seed 3 --duration 60 --set finding=pipe --out plant.bag\n"
      "  pllit simulate room --frames frames --every 10 --truth depth,edges --set rig=inspection --set scans=0\n"
      "  pllit simulate A1 --out a1.bag && pllit run a1.bag --config inspection --truth a1.tum");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
