// What the tests of writers share: a disk that fills up, a cloud, and a look at bytes.
#pragma once

#include <cstring>
#include <random>
#include <string>

#include "pllit/state/table.hpp"
#include "support/full_disk.hpp"
#include "support/temporary_folder.hpp"

namespace pllit::test {

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
