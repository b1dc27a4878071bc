#include "pllit/sim/sensors.hpp"

#include <utility>

namespace pllit {
namespace {

class ImuSensor : public SimSensor {
 public:
  ImuSensor(const Motion& motion, ImuStream stream, bool accel_in_g)
      : motion_(motion), stream_(std::move(stream)), accel_in_g_(accel_in_g) {}

  Time due() const override { return stream_.next_time(); }
  std::vector<SensorEvent> take() override {
    ImuSample sample = stream_.next(motion_);
    if (accel_in_g_) sample.accel_mps2 /= kStandardGravity_mps2;
    return {{sample.time, sample}};
  }

 private:
  const Motion& motion_;
  ImuStream stream_;
  bool accel_in_g_;
};

class BoxLidarSensor : public SimSensor {
 public:
  BoxLidarSensor(const Motion& motion, const SpinningLidar& lidar, const PlanesWorld& world, std::uint64_t seed)
      : motion_(motion), lidar_(lidar), world_(world), seed_(seed) {}

  Time due() const override { return motion_.start() + (index_ + 1) * lidar_.pattern.period; }
  std::vector<SensorEvent> take() override {
    const Time end = due();
    // A stream a scan: a lost scan changes nothing in the others.
    const Random random(seed_, 1000 + static_cast<std::uint64_t>(index_++));
    return {{end, simulate_scan(lidar_, world_, motion_, end - lidar_.pattern.period, random)}};
  }

 private:
  const Motion& motion_;
  SpinningLidar lidar_;
  const PlanesWorld& world_;
  std::uint64_t seed_;
  std::int64_t index_ = 0;
};

class RayLidarSensor : public SimSensor {
 public:
  RayLidarSensor(const Motion& motion, const SimRig& rig, Surroundings& around, std::uint64_t seed)
      : lidar_(rig.lidar),
        clock_(rig.lidar_clock),
        around_(around),
        run_{.place = *around.place,
             .caster = around.caster,
             .T_W_L = [&motion, T_I_L = rig.T_I_L](Time time) { return motion.at(time).T_W_I * T_I_L; },
             .start = motion.start(),
             .seed = seed} {}

  Time due() const override { return run_.start + (index_ + 1) * lidar_.pattern.scan_period; }
  std::vector<SensorEvent> take() override {
    const Time end = due();
    LidarScan scan = simulate_scan(lidar_, run_, index_++, around_.arena);
    scan.start += clock_;
    return {{end, std::move(scan)}};
  }

 private:
  RayLidar lidar_;
  Duration clock_;
  Surroundings& around_;
  LidarRun run_;
  std::int64_t index_ = 0;
};

/// What thermal and visible cameras share: when they look, and from where.
class CameraSensor : public SimSensor {
 public:
  CameraSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
               std::uint64_t seed)
      : start_(motion.start()),
        period_(from_seconds(1.0 / stream.rate_hz)),
        clock_(rig.camera_clock),
        around_(around),
        path_([&motion, T_I_C = rig.T_I_C](Time time) { return motion.at(time).T_W_I * T_I_C; }) {
    // Cameras are switched on when they are: no scan ends as they look.
    first_ = start_ + from_seconds(Random(seed, 41).uniform(0.1, 0.9) * to_seconds(period_));
  }

  Time due() const override { return first_ + index_ * period_; }
  std::vector<SensorEvent> take() override {
    const Time time = due();
    ++index_;
    around_.caster.move_to(path_(time).translation(), to_seconds(time - start_));
    std::vector<SensorEvent> events;
    for (cv::Mat& counts : images(time))
      events.push_back({time, CameraFrame{.time = time + clock_, .counts = std::move(counts)}});
    return events;
  }

 protected:
  virtual std::vector<cv::Mat> images(Time time) = 0;

  Time start_, first_;
  Duration period_, clock_;
  Surroundings& around_;
  CameraPath path_;
  std::int64_t index_ = 0;
};

class ThermalSensor : public CameraSensor {
 public:
  ThermalSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
                std::uint64_t seed, Sightings& sightings)
      : CameraSensor(motion, rig, stream, around, seed),
        stream_(stream),
        camera_(model_of(rig, stream), *around.place, motion.start(), seed),
        sightings_(sightings) {}

 private:
  static ThermalCameraModel model_of(const SimRig& rig, const ImageStream& stream) {
    ThermalCameraModel model = *rig.thermal;
    model.rate_hz = stream.rate_hz;
    if (stream.ideal) {
      model.netd_K = 0.0;
      model.fixed_pattern = {.column_walk = 0.0,
                             .pixel_walk = 0.0,
                             .whole_walk = 0.0,
                             .column_left = 0.0,
                             .pixel_left = 0.0,
                             .whole_left = 0.0};
    }
    return model;
  }

  std::vector<cv::Mat> images(Time time) override {
    ThermalFrame frame = camera_.capture(around_.caster, path_, time, around_.arena);
    if (!frame.frozen) sightings_.look(around_.caster, camera_.model().camera, path_(time), to_seconds(time - start_));
    std::vector<cv::Mat> images;
    if (stream_.agc) images.push_back(std::move(frame.grey));
    if (stream_.counts) images.push_back(std::move(frame.counts));
    return images;
  }

  ImageStream stream_;
  ThermalCamera camera_;
  Sightings& sightings_;
};

class VisibleSensor : public CameraSensor {
 public:
  VisibleSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
                std::uint64_t seed)
      : CameraSensor(motion, rig, stream, around, seed), camera_(*rig.visible, *around.place, motion.start(), seed) {}

 private:
  std::vector<cv::Mat> images(Time time) override {
    return {camera_.capture(around_.caster, path_, time, around_.arena).grey};
  }
  VisibleCamera camera_;
};

}  // namespace

std::unique_ptr<SimSensor> imu_sensor(const Motion& motion, ImuStream stream, bool accel_in_g) {
  return std::make_unique<ImuSensor>(motion, std::move(stream), accel_in_g);
}

std::unique_ptr<SimSensor> box_lidar_sensor(const Motion& motion, const SpinningLidar& lidar, const PlanesWorld& world,
                                            std::uint64_t seed) {
  return std::make_unique<BoxLidarSensor>(motion, lidar, world, seed);
}

std::unique_ptr<SimSensor> lidar_sensor(const Motion& motion, const SimRig& rig, Surroundings& around,
                                        std::uint64_t seed) {
  return std::make_unique<RayLidarSensor>(motion, rig, around, seed);
}

std::unique_ptr<SimSensor> thermal_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                          Surroundings& around, std::uint64_t seed, Sightings& sightings) {
  return std::make_unique<ThermalSensor>(motion, rig, stream, around, seed, sightings);
}

std::unique_ptr<SimSensor> visible_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                          Surroundings& around, std::uint64_t seed) {
  return std::make_unique<VisibleSensor>(motion, rig, stream, around, seed);
}

}  // namespace pllit
