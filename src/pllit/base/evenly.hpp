// Fewer of many values.
#pragma once

#include <cstddef>
#include <vector>

namespace pllit {

/// At most `count` values, evenly by index.
template <class Value>
std::vector<Value> evenly(const std::vector<Value>& values, std::size_t count) {
  if (values.size() <= count) return values;
  std::vector<Value> kept;
  for (std::size_t i = 0; i < count; ++i) kept.push_back(values[i * values.size() / count]);
  return kept;
}

}  // namespace pllit
