#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/ground.hpp"
#include "pllit/sim/places/street_traffic.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::at;

constexpr double kKerb_m = 6.0;      // half the width of the carriageway
constexpr double kPavement_m = 9.0;  // to where the pavement reaches
constexpr double kStep_m = 0.12;     // height of the kerb
constexpr double kFront_m = 9.3;     // where houses start
constexpr double kLand_m = 45.0;     // to where there is land beside a street
constexpr double kCell_m = 5.0;

/// All that a tile is made from; shared by every tile.
struct Street {
  PlaceConfig config;
  Site site;
  Ground ground;
  StreetLine line;
};

/// Makes one piece of street. Meshes are relative to the middle of the piece.
class PieceBuilder {
 public:
  PieceBuilder(const Street& street, std::uint32_t index)
      : street_(street),
        piece_(street.line.pieces()[index]),
        index_(index),
        random_(street.config.seed, 1000 + index),
        origin_(origin(street, index)) {}

  static Vector3d origin(const Street& street, std::uint32_t index) {
    const auto& piece = street.line.pieces()[index];
    const Vector2d p = street.line.stations()[(piece.first + piece.last) / 2].p;
    return {p.x(), p.y(), street.ground.z(p)};
  }

  Mesh make() {
    add_land();
    add_road();
    for (const double side : {-1.0, 1.0}) {
      add_plots(side);
      add_kerbside(side);
      add_parked_cars(side);
    }
    return std::move(mesh_);
  }

 private:
  using Station = StreetLine::Station;
  const Station& station(std::size_t i) const { return street_.line.stations()[i]; }
  Vector3f relative(const Vector2d& p, double above_m) const {
    return (Vector3d(p.x(), p.y(), street_.ground.z(p) + above_m) - origin_).cast<float>();
  }
  /// Land hides below what lies on it, and comes up behind the pavement.
  double land_above_m(const Vector2d& p) const { return to_street_m(p) < kPavement_m ? -0.08 : 0.08; }
  double to_street_m(const Vector2d& p) const { return street_.line.distance_m(p, 20.0); }

  bool add(const Mesh& mesh) {
    if (street_.site.path_P.meets(mesh, origin_, street_.site.clearance_m + 0.02)) return false;
    mesh_.append(mesh);
    return true;
  }
  void add_quad(const std::array<Vector2d, 4>& corners, const std::array<double, 4>& above_m, Material material) {
    const Vector3f a = relative(corners[0], above_m[0]), b = relative(corners[1], above_m[1]),
                   d = relative(corners[3], above_m[3]);
    Mesh quad = shapes::panel(a, b - a, d - a, {material});
    quad.vertices[3] = relative(corners[2], above_m[2]);
    mesh_.append(quad);
  }

  /// Cells of a grid that all tiles share, each made by the piece whose street is nearest; a little below what lies on
  /// it.
  void add_land() {
    Eigen::AlignedBox2d box;
    for (std::size_t i = piece_.first; i <= piece_.last; ++i) box.extend(station(i).p);
    const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell_m)); };
    for (int x = cell(box.min().x() - kLand_m); x <= cell(box.max().x() + kLand_m); ++x)
      for (int y = cell(box.min().y() - kLand_m); y <= cell(box.max().y() + kLand_m); ++y) {
        const Vector2d low(x * kCell_m, y * kCell_m), dx(kCell_m, 0.0), dy(0.0, kCell_m),
            middle = low + 0.5 * (dx + dy);
        if (street_.line.owner(middle, kLand_m) != static_cast<std::ptrdiff_t>(index_)) continue;
        const std::array corners{low, Vector2d(low + dx), Vector2d(low + dx + dy), Vector2d(low + dy)};
        std::array<double, 4> above_m{};
        std::ranges::transform(corners, above_m.begin(), [&](const Vector2d& p) { return land_above_m(p); });
        add_quad(corners, above_m, to_street_m(middle) < kPavement_m + kCell_m ? Material::earth : Material::grass);
      }
  }

  void add_road() {
    struct Strip {
      double from_m, to_m, from_z, to_z;
      Material material;
    };
    constexpr std::array kStrips{Strip{-kPavement_m, -kKerb_m - 0.15, kStep_m, kStep_m, Material::pavement},
                                 Strip{-kKerb_m - 0.15, -kKerb_m, kStep_m, kStep_m, Material::kerb},
                                 Strip{-kKerb_m, -kKerb_m + 0.02, kStep_m, 0.0, Material::kerb},
                                 Strip{-kKerb_m + 0.02, 0.0, 0.0, 0.0, Material::asphalt},
                                 Strip{0.0, kKerb_m - 0.02, 0.0, 0.0, Material::asphalt},
                                 Strip{kKerb_m - 0.02, kKerb_m, 0.0, kStep_m, Material::kerb},
                                 Strip{kKerb_m, kKerb_m + 0.15, kStep_m, kStep_m, Material::kerb},
                                 Strip{kKerb_m + 0.15, kPavement_m, kStep_m, kStep_m, Material::pavement}};
    for (std::size_t i = piece_.first; i < piece_.last; ++i) {
      const Station &a = station(i), &b = station(i + 1);
      for (const Strip& s : kStrips) {
        const std::array corners{Vector2d(a.p + s.from_m * a.left), Vector2d(b.p + s.from_m * b.left),
                                 Vector2d(b.p + s.to_m * b.left), Vector2d(a.p + s.to_m * a.left)};
        const bool raised = s.material != Material::asphalt;  // raised strips give way to streets that branch off
        if (raised && to_street_m(0.25 * (corners[0] + corners[1] + corners[2] + corners[3])) < kKerb_m - 0.2) continue;
        add_quad(corners, {s.from_z, s.from_z, s.to_z, s.to_z}, s.material);
      }
      if (i % 6 < 3)
        add_quad({a.p + 1.65 * a.left, b.p + 1.65 * b.left, b.p + 1.77 * b.left, a.p + 1.77 * a.left},
                 {0.006, 0.006, 0.006, 0.006}, Material::lane_paint);
    }
    if (random_.uniform() < 0.3 && piece_.last > piece_.first + 8) {
      const Station& s = station(piece_.first + 4);
      const Vector2d along(s.left.y(), -s.left.x());
      for (double y = -5.5; y < 5.5; y += 1.0) {
        const Vector2d p = s.p + y * s.left;
        add_quad({p, p + 3.0 * along, p + 3.0 * along + 0.5 * s.left, p + 0.5 * s.left}, {0.006, 0.006, 0.006, 0.006},
                 Material::lane_paint);
      }
    }
  }

  /// Whether all of a rectangle that starts at the front and goes back stays off every street.
  bool fits(const Vector2d& front, const Vector2d& away, double width_m, double depth_m) const {
    const Vector2d along(-away.y(), away.x());
    for (double y = -0.5 * width_m; y <= 0.5 * width_m + 0.1; y += width_m / 8.0)
      for (double x = 0.0; x <= depth_m + 0.1; x += depth_m / 6.0)
        if (to_street_m(front + x * away + y * along) < kFront_m - 0.6) return false;
    return true;
  }

  void add_plots(double side) {
    constexpr std::array kWalls{Material::facade_plaster, Material::facade_plaster, Material::facade_brick,
                                Material::facade_stone};
    for (double s = 0.0; s < static_cast<double>(piece_.last - piece_.first) - 5.0;) {
      const double width_m = random_.uniform(9.0, 16.0),
                   setback_m = random_.uniform() < 0.7 ? 0.0 : random_.uniform(0.5, 3.0);
      const auto middle = std::min(piece_.last, piece_.first + static_cast<std::size_t>(s + 0.5 * width_m));
      s += width_m;
      const Vector2d away = side * station(middle).left, front = station(middle).p + (kFront_m + setback_m) * away;
      const float yaw = static_cast<float>(std::atan2(-away.y(), -away.x()));
      const shapes::House house{.width = static_cast<float>(width_m) - between(random_, 0.0, 0.3),
                                .storeys = 2 + static_cast<int>(random_.uniform() * 3.0),
                                .wall = kWalls[static_cast<std::size_t>(random_.uniform() * kWalls.size())]};
      const bool built = random_.uniform() < 0.82;
      Mesh mesh = shapes::house(house, random_);
      if (built && fits(front, away, width_m, static_cast<double>(house.depth))) {
        add(at(mesh, relative(front, kStep_m), yaw));
      } else if (fits(front, away, width_m, 2.0)) {
        add(at(shapes::fence(static_cast<float>(width_m) - 0.5F, random_), relative(front, 0.05), yaw));
        for (int i = 0; i < 2; ++i)
          add(at(shapes::tree(between(random_, 4.0, 8.0), 420, random_),
                 relative(front + random_.uniform(2.5, 5.0) * away +
                              random_.uniform(-4.0, 4.0) * Vector2d(-away.y(), away.x()),
                          0.0)));
      }
    }
  }

  void add_kerbside(double side) {
    for (std::size_t i = piece_.first + 2 + static_cast<std::size_t>(random_.uniform() * 4.0); i < piece_.last;
         i += 4 + static_cast<std::size_t>(random_.uniform() * 5.0)) {
      const Vector2d away = side * station(i).left, p = station(i).p + (kKerb_m + 0.7) * away;
      const double choice = random_.uniform();
      const float to_road = static_cast<float>(std::atan2(-away.y(), -away.x()));
      if (to_street_m(p) < kKerb_m + 0.3) continue;
      const auto put = [&](const Mesh& mesh) { add(at(mesh, relative(p, kStep_m), to_road)); };
      if (choice < 0.35)
        put(shapes::tree(between(random_, 4.5, 8.0), 480, random_));
      else if (choice < 0.5)
        put(shapes::street_lamp(between(random_, 5.0, 6.5)));
      else if (choice < 0.65)
        put(shapes::sign(random_));
      else if (choice < 0.8)
        put(shapes::bin(random_));
      else if (choice < 0.9)
        put(shapes::cabinet({0.35F, 0.9F, 1.1F}, random_));
      else
        put(shapes::cylinder(0.06F, 0.9F, 8, {Material::street_metal}));
    }
  }

  void add_parked_cars(double side) {
    for (std::size_t i = piece_.first + 3; i + 3 < piece_.last; i += 6) {
      if (random_.uniform() > 0.42) continue;
      const Vector2d p = station(i).p + side * random_.uniform(4.95, 5.15) * station(i).left;
      if (to_street_m(p) < 4.7) continue;
      const float yaw = static_cast<float>(std::atan2(-station(i).left.x(), station(i).left.y())) +
                        between(random_, -0.03, 0.03) + (side > 0.0 ? 3.14159265F : 0.0F);
      add(at(shapes::car(random_), relative(p, 0.01), yaw));
    }
  }

  const Street& street_;
  const StreetLine::Piece piece_;
  const std::uint32_t index_;
  Random random_;
  const Vector3d origin_;
  Mesh mesh_;
};

}  // namespace

Expected<PlaceParts> make_street(const PlaceConfig& config) {
  const Site site = site_on_slopes(config, 0.0);
  const auto street = std::make_shared<const Street>(config, site, Ground(site), StreetLine(site));
  PlaceParts parts;
  parts.surfaces = palette(config.seed, config.light == Light::night);
  parts.climate = outdoor_climate(config.light, config.seed);
  parts.actors = street_traffic(config, site, street->line, street->ground);
  for (std::uint32_t i = 0; i < street->line.pieces().size(); ++i) {
    const Vector3d origin_W = site.T_W_P.act(PieceBuilder::origin(*street, i));
    Eigen::AlignedBox3d bounds_W;
    const auto& piece = street->line.pieces()[i];
    for (std::size_t k = piece.first; k <= piece.last; ++k) {
      const Vector2d p = street->line.stations()[k].p;
      bounds_W.extend(site.T_W_P.act(Vector3d(p.x(), p.y(), street->ground.z(p))));
    }
    const Vector3d reach(kLand_m + kCell_m, kLand_m + kCell_m, 22.0);
    parts.tiles.push_back({origin_W, {Vector3d(bounds_W.min() - reach), Vector3d(bounds_W.max() + reach)}});
  }
  parts.mesh = [street](std::uint32_t index) { return PieceBuilder(*street, index).make(); };
  return parts;
}

}  // namespace pllit
