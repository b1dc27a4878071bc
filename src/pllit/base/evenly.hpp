// Fewer of many values.
#pragma once

#include <cstddef>
#include <vector>

namespace pllit {

/// At most `count` values, evenly by index.
template <class Values>
std::vector<typename Values::value_type> evenly(const Values& values, std::size_t count) {
  if (values.size() <= count) return {values.begin(), values.end()};
  std::vector<typename Values::value_type> kept;
  kept.reserve(count);
  for (std::size_t i = 0; i < count; ++i) kept.push_back(values[i * values.size() / count]);
  return kept;
}

}  // namespace pllit
