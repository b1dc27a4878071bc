#include "pllit/sim/sensors.hpp"

#include <optional>
#include <utility>

#include "pllit/sim/camera/illumination.hpp"

namespace pllit {
namespace {

constexpr double kEdgeReach_m = 100.0;

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
class CameraSensor : public ImageSensor {
 public:
  CameraSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
               std::uint64_t seed)
      : start_(motion.start()),
        period_(from_seconds(1.0 / stream.rate_hz)),
        clock_(rig.camera_clock),
        around_(around),
        camera_(*rig.camera()),
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
  ImageTruth truth(const TruthWanted& wanted) override {
    const Time taken = due() - period_;
    const double t_s = to_seconds(taken - start_);
    ImageTruth truth{
        .seen = taken - delay(), .T_W_C = path_(taken - delay()), .frozen = frozen_, .pixels = {}, .edges = {}};
    if (!rays_) rays_.emplace(camera_);
    if (wanted.pixels) {
      const ThermalBand band;
      const Heat heat(*around_.place, band, t_s, rays_->pixel_rad());
      truth.pixels = pixel_truth(*rays_, around_.caster, heat, truth.T_W_C, around_.arena);
    }
    if (wanted.edges) {
      if (!edges_) edges_.emplace(*around_.place, kEdgeReach_m);
      const PlaceEdges::View view{.camera = camera_, .T_W_C = truth.T_W_C, .actors_s = t_s};
      truth.edges = edges_->visible(view, around_.caster, contrast_shade(t_s, rays_->pixel_rad()), around_.arena);
    }
    return truth;
  }

 protected:
  virtual std::vector<cv::Mat> images(Time time) = 0;
  /// Between the moment that an image shows and its time.
  virtual Duration delay() const = 0;
  /// In the unit that contrasts are told in. Valid as long as the sensor.
  virtual Shade contrast_shade(double t_s, float pixel_rad) const = 0;

  Time start_, first_;
  Duration period_, clock_;
  Surroundings& around_;
  Camera camera_;
  std::optional<RayTable> rays_;     // made with the first truth asked for
  std::optional<PlaceEdges> edges_;  // likewise
  CameraPath path_;
  bool frozen_ = false;
  std::int64_t index_ = 0;
};

class ThermalSensor : public CameraSensor {
 public:
  ThermalSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
                std::uint64_t seed, Sightings& sightings)
      : CameraSensor(motion, rig, stream, around, seed),
        stream_(stream),
        thermal_(model_of(rig, stream), *around.place, motion.start(), seed),
        sightings_(sightings) {}

 private:
  static ThermalCameraModel model_of(const SimRig& rig, const ImageStream& stream) {
    ThermalCameraModel model = *rig.thermal;
    model.rate_hz = stream.rate_hz;
    if (stream.ideal) {
      model.netd_K = 0.0;
      model.fixed_pattern = kNoFixedPattern;
    }
    return model;
  }

  std::vector<cv::Mat> images(Time time) override {
    ThermalFrame frame = thermal_.capture(around_.caster, path_, time, around_.arena);
    frozen_ = frame.frozen;
    if (!frame.frozen) sightings_.look(around_.caster, camera_, path_(time), to_seconds(time - start_));
    std::vector<cv::Mat> images;
    if (stream_.agc) images.push_back(std::move(frame.grey));
    if (stream_.counts) images.push_back(std::move(frame.counts));
    return images;
  }

  Duration delay() const override { return from_seconds(thermal_.model().time_constant_s); }
  Shade contrast_shade(double t_s, float pixel_rad) const override {
    return [this, heat = Heat(*around_.place, band_, t_s, pixel_rad)](auto rays, auto hits, std::size_t samples,
                                                                      std::span<float> kelvin) {
      heat.shade(around_.caster, rays, hits, samples, kelvin);
      for (float& value : kelvin) value /= band_.slope(300.0F);
    };
  }

  ImageStream stream_;
  ThermalBand band_;
  ThermalCamera thermal_;
  Sightings& sightings_;
};

class VisibleSensor : public CameraSensor {
 public:
  VisibleSensor(const Motion& motion, const SimRig& rig, const ImageStream& stream, Surroundings& around,
                std::uint64_t seed)
      : CameraSensor(motion, rig, stream, around, seed), visible_(*rig.visible, *around.place, motion.start(), seed) {}

 private:
  std::vector<cv::Mat> images(Time time) override {
    return {visible_.capture(around_.caster, path_, time, around_.arena).grey};
  }
  Duration delay() const override { return Duration{0}; }
  Shade contrast_shade(double t_s, float pixel_rad) const override {
    return [this, light = Illumination(*around_.place, t_s, pixel_rad)](auto rays, auto hits, std::size_t samples,
                                                                        auto brightness) {
      light.shade(around_.caster, rays, hits, samples, brightness);
    };
  }

  VisibleCamera visible_;
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

std::unique_ptr<ImageSensor> thermal_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                            Surroundings& around, std::uint64_t seed, Sightings& sightings) {
  return std::make_unique<ThermalSensor>(motion, rig, stream, around, seed, sightings);
}

std::unique_ptr<ImageSensor> visible_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                            Surroundings& around, std::uint64_t seed) {
  return std::make_unique<VisibleSensor>(motion, rig, stream, around, seed);
}

}  // namespace pllit
