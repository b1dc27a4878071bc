// What the tests of writers share: a disk that fills up, and a cloud.
#pragma once

#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <random>
#include <string>

#include "pllit/state/table.hpp"
#include "support/temporary_folder.hpp"

namespace pllit::test {

/// While it lives no file of this process grows beyond `bytes`: writes fail as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : signal_before_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_before_);
  }

 private:
  void (*signal_before_)(int);
  rlimit before_{};
};

/// Points within 50 m of (100, -20, 3), with two scalar fields that tell each point and field from the others.
inline PointTable some_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> near(-50.0F, 50.0F);
  PointTable table{{}, {{"temperature_c", {}}, {"n_obs", {}}}};
  for (std::size_t i = 0; i < count; ++i) {
    table.points.emplace_back(100.0F + near(random), -20.0F + near(random), 3.0F + near(random));
    table.fields[0].values.push_back(near(random));
    table.fields[1].values.push_back(static_cast<float>(i));
  }
  return table;
}

inline bool same_points(const PointTable& a, const PointTable& b) {
  const auto same_field = [](const ScalarField& x, const ScalarField& y) {
    return x.name == y.name && x.values == y.values;
  };
  return a.points == b.points && std::ranges::equal(a.fields, b.fields, same_field);
}

/// The number whose little-endian bytes lie at `offset`.
template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.substr(offset, sizeof value).data(), sizeof value);
  return value;
}

}  // namespace pllit::test
