#include "pllit/report/view3d.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "pllit/report/html.hpp"
#include "pllit/report/pictures.hpp"

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kCanvas = R"(<canvas id="view3d" width="960" height="600"></canvas>
<p class="muted"><label>Shown up to a height of <input id="view3d-top" type="range" step="any"> <span id="view3d-m"></span></label>
&middot; drag to turn, wheel or two fingers to come nearer</p>
)";

/// Points go into an image with their depths; way and rings are drawn over it.
constexpr std::string_view kScript = R"(
(() => {
const d = JSON.parse(document.getElementById('view3d-data').textContent);
const canvas = document.getElementById('view3d'), g = canvas.getContext('2d'), top = document.getElementById('view3d-top');
const bytes = Uint8Array.from(atob(d.points), c => c.charCodeAt(0)), view = new DataView(bytes.buffer), n = bytes.length / 7;
const W = canvas.width, H = canvas.height, depth = new Float32Array(W * H);
let yaw = 0.5, tilt = 0.9, zoom = 1, pinch = 0;
const held = new Map();
const colour = level => { const s = level / 255; return d.coloured ?
  [255 * Math.min(1, 1.7 * s), 255 * Math.max(0, 1.6 * s - 0.6), 255 * Math.max(0, s < 0.5 ? 1.2 * s : 1.3 - 1.8 * s, 4 * s - 3)] :
  [90 + 120 * s, 90 + 120 * s, 90 + 120 * s]; };
const lut = Array.from({length: 256}, (_, i) => colour(i));
const project = p => {
  const x = p[0] - d.centre[0], y = p[1] - d.centre[1], z = p[2] - d.centre[2], k = zoom * 1.3 * H / d.size;
  const a = x * Math.cos(yaw) - y * Math.sin(yaw), b = x * Math.sin(yaw) + y * Math.cos(yaw);
  return [W / 2 + k * a, H / 2 - k * (z * Math.cos(tilt) + b * Math.sin(tilt)), b * Math.cos(tilt) - z * Math.sin(tilt)];
};
const points = image => {
  for (let i = 0; i < n; i++) {
    const p = [0, 1, 2].map(k => d.low[k] + d.step * view.getUint16(7 * i + 2 * k, true));
    if (p[2] > +top.value) continue;
    const [u, v, w] = project(p), c = lut[view.getUint8(7 * i + 6)];
    for (let y = v | 0; y < (v | 0) + 2; y++) for (let x = u | 0; x < (u | 0) + 2; x++) {
      const at = y * W + x;
      if (x < 0 || y < 0 || x >= W || y >= H || w >= depth[at]) continue;
      depth[at] = w;
      image.data.set(c, 4 * at);
    }
  }
};
const draw = () => {
  g.fillStyle = '#101014';
  g.fillRect(0, 0, W, H);
  depth.fill(Infinity);
  const image = g.getImageData(0, 0, W, H);
  points(image);
  g.putImageData(image, 0, 0);
  g.strokeStyle = g.fillStyle = '#fff';
  g.lineWidth = 2;
  g.beginPath();
  d.way.forEach((p, i) => { const [u, v] = project(p); i ? g.lineTo(u, v) : g.moveTo(u, v); });
  g.stroke();
  g.font = 'bold 20px sans-serif';
  for (const f of d.findings) {
    const [u, v] = project(f.position_m);
    g.strokeStyle = '#e22'; g.lineWidth = 6; g.beginPath(); g.arc(u, v, 14, 0, 7); g.stroke();
    g.strokeStyle = '#fff'; g.lineWidth = 2; g.stroke();
    g.fillText(f.id, u + 18, v + 7);
  }
  document.getElementById('view3d-m').textContent = (+top.value).toFixed(1) + ' m';
};
const spread = () => { const [a, b] = [...held.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
canvas.onpointerdown = e => { canvas.setPointerCapture(e.pointerId); held.set(e.pointerId, [e.clientX, e.clientY]);
  if (held.size == 2) pinch = spread() / zoom; };
canvas.onpointerup = canvas.onpointercancel = e => held.delete(e.pointerId);
canvas.onpointermove = e => {
  const last = held.get(e.pointerId);
  if (!last) return;
  held.set(e.pointerId, [e.clientX, e.clientY]);
  if (held.size == 2) zoom = spread() / pinch;
  else { yaw += 0.01 * (e.clientX - last[0]); tilt = Math.min(1.57, Math.max(0, tilt + 0.01 * (e.clientY - last[1]))); }
  draw();
};
canvas.onwheel = e => { e.preventDefault(); zoom *= Math.exp(-0.001 * e.deltaY); draw(); };
top.min = d.low[2]; top.max = d.high; top.value = d.shown;
top.oninput = draw;
draw();
})();
)";

std::vector<std::uint8_t> levels_of(const std::vector<float>& values) {
  const Stretch stretch(values);
  std::vector<std::uint8_t> levels;
  for (const float value : values) levels.push_back(static_cast<std::uint8_t>(stretch(value)));
  return levels;
}

/// The box of the map but for a few stray points.
Eigen::AlignedBox3d box_of(const std::vector<Vector3f>& points_W) {
  Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (const Vector3f& p_W : points_W) values.push_back(p_W[axis]);
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    low[axis] = static_cast<double>(values[static_cast<std::size_t>(0.005 * last)]);
    high[axis] = static_cast<double>(values[static_cast<std::size_t>(0.995 * last)]);
  }
  return {low, high};
}

/// Seven bytes a point: x, y, z in steps from the low corner (little-endian), and its level.
std::string packed(const PointTable& map, const Eigen::AlignedBox3d& box_W, double step_m, const View3dConfig& config) {
  const std::vector<float>* intensity = find_field(map, "intensity");
  const std::vector<std::uint8_t> levels =
      intensity ? levels_of(*intensity) : std::vector<std::uint8_t>(map.points.size(), 255);
  const std::size_t every = 1 + map.points.size() / std::max<std::size_t>(1, config.most_points);
  std::string bytes;
  for (std::size_t i = 0; i < map.points.size(); i += every) {
    const Vector3d p_W = map.points[i].cast<double>();
    if (!box_W.contains(p_W)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const auto steps = static_cast<std::uint16_t>((p_W[axis] - box_W.min()[axis]) / step_m);
      bytes += static_cast<char>(steps & 255);
      bytes += static_cast<char>(steps >> 8);
    }
    bytes += static_cast<char>(levels[i]);
  }
  return bytes;
}

Json rounded(const Vector3d& p_W) {
  Json json = Json::array();
  for (int axis = 0; axis < 3; ++axis) json.push_back(std::round(1e3 * p_W[axis]) / 1e3);
  return json;
}

/// Points of the way half a metre apart.
Json way_of(const Trajectory& trajectory) {
  constexpr double kSpacing_m = 0.5;
  Json way = Json::array();
  std::optional<Vector3d> last_W;
  for (const StampedPose& pose : trajectory) {
    const Vector3d p_W = pose.T_W_I.translation();
    if (last_W && (p_W - *last_W).norm() < kSpacing_m) continue;
    way.push_back(rounded(p_W));
    last_W = p_W;
  }
  return way;
}

}  // namespace

std::string view3d(const PointTable& map, const Trajectory& trajectory, std::span<const Anomaly> alarms,
                   const View3dConfig& config) {
  if (map.points.empty()) return "";
  const Eigen::AlignedBox3d box_W = box_of(map.points);
  const double longest_m = std::max(1.0, box_W.sizes().maxCoeff()), step_m = longest_m / 65000.0;
  double way_z_m = box_W.max().z();
  if (!trajectory.empty()) {
    way_z_m = 0.0;
    for (const StampedPose& pose : trajectory) way_z_m += pose.T_W_I.translation().z() / double(trajectory.size());
  }
  Json data{{"centre", rounded(box_W.center())},
            {"size", longest_m},
            {"low", rounded(box_W.min())},
            {"high", box_W.max().z()},
            {"shown", std::min(box_W.max().z(), way_z_m + config.above_way_m)},
            {"step", step_m},
            {"coloured", find_field(map, "intensity") != nullptr},
            {"way", way_of(trajectory)},
            {"findings", Json::array()},
            {"points", base64(packed(map, box_W, step_m, config))}};
  for (const Anomaly& alarm : alarms)
    data["findings"].push_back({{"id", alarm.id}, {"position_m", rounded(alarm.position_W)}});
  std::string html(kCanvas);
  html += "<script type=\"application/json\" id=\"view3d-data\">" + data.dump() + "</script>\n<script>";
  html += kScript;
  return html + "</script>\n";
}

}  // namespace pllit
