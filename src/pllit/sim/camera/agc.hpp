// Automatic gain control: how thermal cameras squeeze 14 bits into 8.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace pllit {

struct AgcConfig {
  enum class Kind {
    linear,  ///< a straight line between two quantiles
    plateau  ///< equalisation with a clipped histogram
  };
  Kind kind = Kind::plateau;
  double tail = 0.01;          ///< linear: share of the pixels rejected at either end
  double plateau = 0.003;      ///< share of the pixels at which the histogram is clipped, each count a bin
  double max_gain = 4.0;       ///< grey levels a count
  double middle_grey = 127.5;  ///< where the middle of the mapping lies when the gain limit leaves greys unused
  int speed_256 = 32;          ///< alpha: share, in 256ths, of the new mapping in each frame's; 256 is immediate
};

/// Grey, 0 to 255, of each count up to a camera's highest.
using GreyMapping = std::vector<float>;

/// The mapping that one image asks for. counts: CV_16UC1 below `levels`.
/// linear: the counts at the two tails get 0 and 255, unless max_gain is less; then the line is flatter about
/// middle_grey. plateau: grey grows at each count by 255 times that count's share of the histogram clipped at the
/// plateau, but by no more than max_gain; the result is centred on middle_grey. (The definitions follow FLIR's
/// descriptions of the Tau 2.)
GreyMapping grey_mapping(const cv::Mat& counts, const AgcConfig& config, int levels);

/// n = n' alpha / 256 + n_before (256 - alpha) / 256, as in the Tau 2; n' where there was none before.
GreyMapping smoothed(const GreyMapping& before, GreyMapping now, int speed_256);

/// CV_8UC1.
cv::Mat applied(const GreyMapping& mapping, const cv::Mat& counts);

}  // namespace pllit
