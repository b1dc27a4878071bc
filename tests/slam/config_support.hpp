// Helpers of the configuration's tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

#include "pllit/slam/config_keys.hpp"
#include "pllit/slam/config_yaml.hpp"

namespace pllit::test {

/// The message that loading the text ends with; the test fails where it loads.
inline std::string load_error(std::string_view yaml) {
  const auto config = load_config(yaml, "my.yaml");
  if (config) {
    ADD_FAILURE() << "loaded without error:\n" << yaml;
    return "";
  }
  EXPECT_EQ(config.error().kind, Error::Kind::input);
  return config.error().message;
}

/// Draws values for every kind of key, inside its limits.
class RandomValue {
 public:
  explicit RandomValue(unsigned seed) : random_(seed) {}

  void draw(Key& key) {
    limits_ = key.limits;
    std::visit([this](auto& value) { set(value); }, key.value);
  }

 private:
  double real() { return std::uniform_real_distribution<double>(limits_.min, limits_.max)(random_); }
  int whole() {
    return std::uniform_int_distribution<int>(static_cast<int>(limits_.min), static_cast<int>(limits_.max))(random_);
  }

  void set(double* value) { *value = real(); }
  void set(int* value) { *value = whole(); }
  void set(Duration* value) { *value = from_seconds(real()); }
  void set(std::span<double> values) {
    std::ranges::generate(values, [this] { return real(); });
  }
  void set(std::span<int> values) {
    std::ranges::generate(values, [this] { return whole(); });
  }
  void set(const Choice& choice) { choice.set(static_cast<std::size_t>(random_() % choice.words.size())); }
  void set(std::string* value) {
    value->clear();
    for (auto n = random_() % 12; n > 0; --n)
      *value += static_cast<char>('!' + std::uniform_int_distribution<int>(0, 93)(random_));
  }
  void set(PoseConfig* pose) {
    std::ranges::generate(pose->translation_m, [this] { return real(); });
    std::normal_distribution<double> normal;
    std::ranges::generate(pose->rotation_xyzw, [&] { return normal(random_); });
    Eigen::Map<Eigen::Vector4d>(pose->rotation_xyzw.data()).normalize();
  }

  std::mt19937 random_;
  Limits limits_;
};

/// A configuration with every key drawn anew that `check` accepts.
inline Config random_config(unsigned seed) {
  Config config;
  RandomValue value(seed);
  for (Key& key : keys_of(config).keys) value.draw(key);
  std::ranges::sort(config.rig.lidar.range_m);
  if (config.thermography.unit_choice != UnitChoice::kelvin) config.thermography.radiometry = {};
  RigConfig::Camera& camera = config.rig.camera;
  if (seed % 3 == 0) camera.size_px = {0, 0};
  for (const int i : {0, 1}) camera.intrinsics_px[2 + i] = 0.5 * camera.size_px[i];
  return config;
}

}  // namespace pllit::test
