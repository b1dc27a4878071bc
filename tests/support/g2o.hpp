// Reads pose graphs in g2o's text format, plane ones lifted into space, and scores them as SE-Sync does.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "pllit/loop/pose_graph.hpp"

namespace pllit::test {

/// A measurement's precisions in SE-Sync's isotropic model.
struct ChordalWeights {
  double rotation = 0.0, translation = 0.0;
};

struct G2oGraph {
  PoseGraph graph;
  std::vector<ChordalWeights> odometry_weights, loop_weights;
};

namespace g2o {

inline Eigen::MatrixXd upper_triangle(std::istream& line, int size) {
  Eigen::MatrixXd m(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = i; j < size; ++j) {
      line >> m(i, j);
      m(j, i) = m(i, j);
    }
  return m;
}

inline SE3 plane_pose(double x, double y, double angle) {
  return pose_from(exp_so3(Vector3d(0.0, 0.0, angle)), Vector3d(x, y, 0.0));
}

/// x, y and heading as measured; height, roll and pitch, which nothing disturbs, stay where they are.
inline void lift(const Eigen::Matrix3d& information, RelativePose& edge, ChordalWeights& weights) {
  const Eigen::Matrix3d covariance = information.inverse();
  const std::array<int, 3> at{3, 4, 2};  // x, y, heading in (theta, p)
  edge.covariance = 1e-4 * Matrix6::Identity();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      edge.covariance(at[i], at[j]) = covariance(static_cast<int>(i), static_cast<int>(j));
  weights = {information(2, 2), 2.0 / information.topLeftCorner<2, 2>().inverse().trace()};
}

inline void read_edge(std::istream& line, bool in_plane, RelativePose& edge, ChordalWeights& weights) {
  line >> edge.from >> edge.to;
  if (in_plane) {
    double x = 0.0, y = 0.0, angle = 0.0;
    line >> x >> y >> angle;
    edge.T_from_to = plane_pose(x, y, angle);
    lift(upper_triangle(line, 3), edge, weights);
    return;
  }
  Vector3d p;
  Eigen::Quaterniond q;
  line >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w();
  edge.T_from_to = pose_from(rotation_from(q), p);
  const Eigen::MatrixXd information = upper_triangle(line, 6);  // (p, theta)
  Matrix6 ordered;
  ordered << information.bottomRightCorner(3, 3), information.bottomLeftCorner(3, 3), information.topRightCorner(3, 3),
      information.topLeftCorner(3, 3);
  edge.covariance = ordered.inverse();
  weights = {3.0 / (2.0 * information.bottomRightCorner<3, 3>().inverse().trace()),
             3.0 / information.topLeftCorner<3, 3>().inverse().trace()};
}

}  // namespace g2o

/// Edges from a pose to the next one are odometry, all others loops. The file's poses are the guesses.
inline G2oGraph read_g2o(const std::filesystem::path& path) {
  G2oGraph read;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    std::istringstream line(text);
    std::string tag;
    int id = 0;
    line >> tag;
    if (tag == "VERTEX_SE2") {
      double x = 0.0, y = 0.0, angle = 0.0;
      line >> id >> x >> y >> angle;
      read.graph.guesses_M.push_back(g2o::plane_pose(x, y, angle));
    } else if (tag == "VERTEX_SE3:QUAT") {
      Vector3d p;
      Eigen::Quaterniond q;
      line >> id >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w();
      read.graph.guesses_M.push_back(pose_from(rotation_from(q), p));
    } else if (tag.starts_with("EDGE_")) {
      RelativePose edge;
      ChordalWeights weights;
      g2o::read_edge(line, tag == "EDGE_SE2", edge, weights);
      const bool step = edge.to == edge.from + 1;
      (step ? read.graph.odometry : read.graph.loops).push_back(edge);
      (step ? read.odometry_weights : read.loop_weights).push_back(weights);
    }
  }
  read.graph.tilt_sigma_rad = 1e-5;  // these graphs know no vertical
  return read;
}

/// SE-Sync's objective: sum of rotation |R_j - R_i R_ij|^2 + translation |t_j - t_i - R_i t_ij|^2 (Rosen, Carlone,
/// Bandeira, Leonard, "SE-Sync", IJRR 2019, problem 1; a plane rotation's norm is that of the 2 x 2 matrix).
inline double chordal_cost(const std::vector<RelativePose>& edges, const std::vector<ChordalWeights>& weights,
                           const std::vector<SE3>& poses) {
  double cost = 0.0;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const SE3& a = poses[static_cast<std::size_t>(edges[k].from)];
    const SE3& b = poses[static_cast<std::size_t>(edges[k].to)];
    const Matrix3d R_a = a.rotation();
    cost += weights[k].rotation * (b.rotation() - R_a * edges[k].T_from_to.rotation()).squaredNorm() +
            weights[k].translation *
                (b.translation() - a.translation() - R_a * edges[k].T_from_to.translation()).squaredNorm();
  }
  return cost;
}

inline double chordal_cost(const G2oGraph& read, const std::vector<SE3>& poses) {
  return chordal_cost(read.graph.odometry, read.odometry_weights, poses) +
         chordal_cost(read.graph.loops, read.loop_weights, poses);
}

}  // namespace pllit::test
