// What the cloud formats share: names that every reader accepts, and points as rows of little-endian floats.
#pragma once

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

static_assert(std::endian::native == std::endian::little, "cloud files are written as memory lies");

/// Appends a number's bytes, little-endian.
template <class Number>
void append_bytes(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::vector<std::string> field_names(const PointTable& table);

/// Fails on a name that cloud formats cannot carry: empty, over 31 characters, repeated, one of x y z, or with
/// characters other than letters, digits and _ . -
Expected<void> check_field_names(const std::vector<std::string>& names);

/// Fails on a field whose length is not the number of points and on a point that is not finite (a value may be NaN).
Expected<void> check_points(const PointTable& table);

/// Rows of x y z and the fields, float32 each, for points [begin, end).
std::string float_rows(const PointTable& table, std::size_t begin, std::size_t end);

/// Calls write(rows) for chunks that fit in a cache, in order, until one fails.
template <class Write>
Expected<void> for_float_rows(const PointTable& table, const Write& write) {
  constexpr std::size_t chunk = 1 << 15;
  for (std::size_t begin = 0; begin < table.points.size(); begin += chunk)
    if (auto done = write(float_rows(table, begin, std::min(begin + chunk, table.points.size()))); !done) return done;
  return {};
}

}  // namespace pllit
