// What is done with image edges once they are found; for image_edges.cpp.
#pragma once

#include <vector>

#include "pllit/sim/camera/image_edges.hpp"

namespace pllit {

/// The fewest of the points such that none is farther than off_px from the line through the rest (Douglas and Peucker).
std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& line_px, double off_px);

/// Edges of one kind that continue each other within 3 px and one degree, as where tiles or panels meet, become one.
std::vector<ImageEdge> joined(std::vector<ImageEdge> edges);

/// Longest first; without those that run along longer ones within 1.5 px, as where a box stands on a floor or a frame
/// lies on a wall, and without those shorter than least_px.
std::vector<ImageEdge> without_doubles(std::vector<ImageEdge> edges, int width, int height, double least_px);

}  // namespace pllit
