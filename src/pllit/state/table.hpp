// Plain tables that the pipeline hands to writers and scores, so that neither needs to know a map or a filter.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace pllit {

/// One named number per point; `values` is as long as the table it belongs to.
struct ScalarField {
  std::string name;
  std::vector<float> values;
};

/// Points in one frame (metres) with any number of scalar fields.
struct PointTable {
  std::vector<Eigen::Vector3f> points;
  std::vector<ScalarField> fields;
};

/// The values of a field; null where the table has none of that name.
inline const std::vector<float>* find_field(const PointTable& table, std::string_view name) {
  const auto found = std::ranges::find(table.fields, name, &ScalarField::name);
  return found == table.fields.end() ? nullptr : &found->values;
}

}  // namespace pllit
