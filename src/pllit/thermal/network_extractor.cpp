#include "pllit/thermal/network_extractor.hpp"

#include <onnxruntime_cxx_api.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <format>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "pllit/thermal/quiet_registration.hpp"

namespace pllit {
namespace {

constexpr int kPadTo_px = 16;
constexpr const char* kInput = "image";
constexpr std::array<const char*, 3> kOutputs{"scores", "descriptors", "lines"};
constexpr std::array<std::int64_t, 3> kChannels{1, kDescriptorSize, line_map::kChannels};

/// Names that configurations use, and ONNX Runtime's.
constexpr std::array<std::pair<const char*, const char*>, 3> kProviders{
    {{"cpu", "CPUExecutionProvider"}, {"cuda", "CUDAExecutionProvider"}, {"tensorrt", "TensorrtExecutionProvider"}}};

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

int padded(int side) { return (side + kPadTo_px - 1) / kPadTo_px * kPadTo_px; }

Expected<void> check_provider(const std::string& provider) {
  const std::vector<std::string> installed = installed_providers();
  if (std::ranges::contains(installed, provider)) return {};
  const bool known = std::ranges::contains(kProviders, provider, &std::pair<const char*, const char*>::first);
  return input_error(std::format("execution provider '{}' is {}; the installed ONNX Runtime has: {}", provider,
                                 known ? "not installed" : "unknown", joined(installed)));
}

Ort::SessionOptions options_for(const NetworkConfig& config) {
  Ort::SessionOptions options;
  options.SetIntraOpNumThreads(std::max(config.threads, 1));
  options.SetInterOpNumThreads(1);
  options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
  // Threads that wait by spinning would take the processor from the LiDAR's stages between two images.
  options.AddConfigEntry("session.intra_op.allow_spinning", "0");
  if (config.provider == "tensorrt") options.AppendExecutionProvider_TensorRT(OrtTensorRTProviderOptions{});
  if (config.provider == "cuda") options.AppendExecutionProvider_CUDA(OrtCUDAProviderOptions{});
  return options;
}

/// Nothing, or how a model's signature differs from what the decoders read.
std::string difference(const Ort::Session& session) {
  Ort::AllocatorWithDefaultOptions allocator;
  if (session.GetInputCount() != 1 || session.GetOutputCount() != kOutputs.size())
    return std::format("has {} inputs and {} outputs, not 1 and {}", session.GetInputCount(), session.GetOutputCount(),
                       kOutputs.size());
  const auto differs = [](const std::string& name, const char* wanted, const Ort::TypeInfo& type,
                          std::int64_t channels) {
    if (name != wanted) return std::format("has '{}' where '{}' belongs", name, wanted);
    if (type.GetONNXType() != ONNX_TYPE_TENSOR) return std::format("'{}' is no tensor", name);
    const auto tensor = type.GetTensorTypeAndShapeInfo();
    const std::vector<std::int64_t> shape = tensor.GetShape();
    if (tensor.GetElementType() != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT || shape.size() != 4 || shape[1] != channels)
      return std::format("'{}' is not made of 1 x {} x height x width floats", name, channels);
    return std::string();
  };
  std::string wrong =
      differs(session.GetInputNameAllocated(0, allocator).get(), kInput, session.GetInputTypeInfo(0), 1);
  for (std::size_t i = 0; i < kOutputs.size() && wrong.empty(); ++i)
    wrong = differs(session.GetOutputNameAllocated(i, allocator).get(), kOutputs[i], session.GetOutputTypeInfo(i),
                    kChannels[i]);
  return wrong;
}

MapView view_of(const Ort::Value& value) {
  const std::vector<std::int64_t> shape = value.GetTensorTypeAndShapeInfo().GetShape();
  return {.values = value.GetTensorData<float>(),
          .channels = static_cast<int>(shape[1]),
          .rows = static_cast<int>(shape[2]),
          .columns = static_cast<int>(shape[3])};
}

std::vector<Corner> corners_in(const cv::Mat& grey, const NetworkConfig& config) {
  return spread_evenly(corners_of(grey, config.corners), config.points.most,
                       static_cast<float>(config.points.most_radius_px));
}

/// The image as floats 0 to 1, its last row and column repeated up to the padded size.
cv::Mat prepared(const cv::Mat& grey) {
  cv::Mat framed, image;
  cv::copyMakeBorder(grey, framed, 0, padded(grey.rows) - grey.rows, 0, padded(grey.cols) - grey.cols,
                     cv::BORDER_REPLICATE);
  framed.convertTo(image, CV_32F, 1.0 / 255.0);
  return image;
}

}  // namespace

struct NetworkExtractor::Session {
  Ort::Env env;
  Ort::Session ort{nullptr};

  Session(Ort::Env environment, Ort::Session session) : env(std::move(environment)), ort(std::move(session)) {}
};

std::vector<std::string> installed_providers() {
  const std::vector<std::string> available = Ort::GetAvailableProviders();
  std::vector<std::string> names;
  for (const auto& [name, runtime_name] : kProviders)
    if (std::ranges::contains(available, runtime_name)) names.emplace_back(name);
  return names;
}

NetworkExtractor::NetworkExtractor(NetworkConfig config, std::unique_ptr<Session> session)
    : config_(std::move(config)),
      session_(std::move(session)),
      name_(std::format("network {}{} on {}", config_.model.filename().string(),
                        config_.place_points == NetworkConfig::Points::corners ? " at corners" : "",
                        config_.provider)) {}

NetworkExtractor::~NetworkExtractor() = default;

Expected<std::unique_ptr<NetworkExtractor>> NetworkExtractor::open(const NetworkConfig& config) {
  const std::string where = "the feature network " + config.model.string();
  std::error_code none;
  if (!std::filesystem::is_regular_file(config.model, none))
    return input_error(where + ": no such file; models/README.md says how to make it");
  if (auto fine = check_provider(config.provider); !fine) return in_context(where, fine.error());
  try {
    Ort::Env env = [] {
      const QuietRegistration quiet;
      return Ort::Env(ORT_LOGGING_LEVEL_ERROR, "pllit");
    }();
    Ort::Session ort(env, config.model.c_str(), options_for(config));
    if (const std::string wrong = difference(ort); !wrong.empty())
      return input_error(where + ": " + wrong + "; it is not a point-line network as models/README.md describes it");
    auto session = std::make_unique<Session>(std::move(env), std::move(ort));
    return std::unique_ptr<NetworkExtractor>(new NetworkExtractor(config, std::move(session)));
  } catch (const Ort::Exception& error) {
    return input_error(where + ": ONNX Runtime cannot load it: " + error.what());
  }
}

Expected<Features> NetworkExtractor::extract(const cv::Mat& grey) {
  if (grey.type() != CV_8UC1 || grey.rows < kPadTo_px || grey.cols < kPadTo_px)
    return input_error(
        std::format("features need an 8-bit image of one channel and at least {0} x {0} pixels; this one has {1} x {2} "
                    "of OpenCV's type {3}",
                    kPadTo_px, grey.cols, grey.rows, grey.type()));
  cv::Mat image = prepared(grey);
  const std::array<std::int64_t, 4> shape{1, 1, image.rows, image.cols};
  const auto memory = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
  try {
    const Ort::Value input =
        Ort::Value::CreateTensor<float>(memory, image.ptr<float>(), image.total(), shape.data(), shape.size());
    const std::vector<Ort::Value> maps =
        session_->ort.Run(Ort::RunOptions{nullptr}, &kInput, &input, 1, kOutputs.data(), kOutputs.size());
    const cv::Mat scores(image.rows, image.cols, CV_32FC1, const_cast<float*>(maps[0].GetTensorData<float>()));
    const std::vector<Corner> points = config_.place_points == NetworkConfig::Points::corners
                                           ? corners_in(grey, config_)
                                           : decode_points(scores, grey.size(), config_.points);
    Features features;
    for (const Corner& point : points) {
      features.points_px.push_back(point.at_px);
      features.scores.push_back(point.strength);
    }
    features.descriptors = sample_descriptors(view_of(maps[1]), points);
    features.lines = decode_lines(view_of(maps[2]), grey.size(), config_.lines);
    turn_brighter_side_left(grey, features.lines);
    return features;
  } catch (const Ort::Exception& error) {
    return failure(
        std::format("{}: ONNX Runtime failed on an image of {} x {}: {}", name_, grey.cols, grey.rows, error.what()));
  }
}

void turn_brighter_side_left(const cv::Mat& grey, std::vector<LineSegment>& lines) {
  constexpr int kPlaces = 9;
  constexpr float kAside_px = 2.0F, kRounding_grey = 0.5F;
  const auto value = [&](const Eigen::Vector2f& p) {
    const int x = std::clamp(static_cast<int>(std::lround(p.x())), 0, grey.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(p.y())), 0, grey.rows - 1);
    return static_cast<float>(grey.at<std::uint8_t>(y, x));
  };
  for (LineSegment& line : lines) {
    const Eigen::Vector2f whole = line.end_px - line.start_px, along = whole.normalized();
    const Eigen::Vector2f left(along.y(), -along.x());  // on the screen, where y points down
    float brighter = 0.0F;
    for (int i = 0; i < kPlaces; ++i) {
      const Eigen::Vector2f at = line.start_px + (static_cast<float>(i) + 0.5F) / kPlaces * whole;
      brighter += value(at + kAside_px * left) - value(at - kAside_px * left);
    }
    if (brighter < -kRounding_grey * kPlaces) std::swap(line.start_px, line.end_px);
  }
}

}  // namespace pllit
