// A field's zero surface as triangles: OpenVDB connects the dots, this file says where they are.
//
// Space is cut into tiles of lattice columns. In a tile an octree of boxes is descended with the field's certified range, down to blocks of 8^3
// points: only blocks that may hold surface are sampled. Each tile is sampled with a margin, so that the points in its outermost cells have the same
// bits as in the neighbour's: that is how they are recognised and joined without a seam. A quadrilateral belongs to the tile its centre lies in.
// Every vertex is then moved along the field's gradient onto the root itself (Illinois steps within a bracket, Dowell1971), in double precision; the
// polygoniser's own points are only as good as the linear interpolation of samples. Quadrilaterals are cut along their shorter diagonal.
// The error is measured, not estimated: from four places of each triangle the way to a root, an upper bound of the distance: along the gradient;
// where that meets none within two cells, along the triangle's normal; else to the nearest of its corners, if that lies on the surface; else ever
// further. Missing: sheets thinner than the lattice (their samples do not show them); adaptive triangles.
#include "terrain/io/polygonise.h"

#include "terrain/error.h"
#include "terrain/io/vdb_tile.h"
#include "terrain/math/hash.h"
#include "terrain/math/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace hoodoo
{

namespace
{

constexpr int block = 8;
constexpr int margin = 8;       // lattice points beyond a tile: the polygoniser looks two cells around
constexpr double shared = 2.0;  // cells from a tile's edge within which a vertex may belong to both sides

/// Distance along the unit vector `n` (towards air) from p to where the field changes its sign, negative against n; none within `reach`.
/// `value` and `slope` are the field's at p.
std::optional<double> root_along(const Field& field, const Vec3d& p, const Vec3d& n, double value, double slope, double reach)
{
    if (value == 0.0) return 0.0;
    const double side = value < 0.0 ? 1.0 : -1.0;
    const auto f = [&](double s) { return field.value(p + n * (side * s)) * side; };  // begins negative, ends positive
    double a = 0.0, fa = -std::abs(value), b = 0.0, fb = fa;
    double step = std::clamp(1.5 * std::abs(value) / std::max(slope, 1e-300), reach / 256, reach / 8);
    while (fb < 0.0) {
        if (b >= reach) return std::nullopt;
        a = b;
        fa = fb;
        b = std::min(b + step, reach);
        fb = f(b);
        step = std::min(2.0 * step, reach / 8);
    }
    int last = 0;
    for (int k = 0; k < 100 && b - a > 1e-10 * reach; ++k) {
        double m = k % 3 == 2 || !(fb > fa) ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
        m = std::clamp(m, a, b);
        const double fm = f(m);
        if (fm < 0.0) {
            a = m;
            fa = fm;
            if (last == -1) fb *= 0.5;
            last = -1;
        } else {
            b = m;
            fb = fm;
            if (last == 1) fa *= 0.5;
            last = 1;
        }
    }
    return side * 0.5 * (a + b);
}

struct Key {
    std::array<std::uint32_t, 3> bits;
    bool operator==(const Key&) const = default;
};

struct KeyHash {
    std::size_t operator()(const Key& key) const { return hash_combine(hash_combine(key.bits[0], key.bits[1]), key.bits[2]); }
};

Key key_of(const Vec3f& p)
{
    return {{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y), std::bit_cast<std::uint32_t>(p.z)}};
}

class Polygoniser
{
public:
    Polygoniser(const Field& field, const PolygoniseOptions& options) : field_(field), options_(options), h_(options.spacing)
    {
        for (int k = 0; k < 3; ++k) {
            const double cells = std::ceil((options.region.max[k] - options.region.min[k]) / h_);
            if (!(cells >= 0.0 && cells < 2147480000.0))
                throw Error(ErrorKind::scene, Problem{{},
                                                      "lattice of a mesh",
                                                      "a finite region and a spacing that divides it into less than 2^31",
                                                      fmt::format("{} steps of {} m", cells, h_),
                                                      {}});
            size_[k] = std::max(1, static_cast<int>(cells));
        }
        if (options.tile < block || options.tile % block != 0) throw Error(ErrorKind::internal, "a tile of a mesh is no multiple of 8 cells");
    }

    PolygoniseReport run(const std::function<void(const MeshPart&)>& deliver)
    {
        const int t = options_.tile;
        for (int y = 0; y < size_[1]; y += t) {
            for (int x = 0; x < size_[0]; x += t) {
                const MeshPart part = make_tile(x, y);
                if (!part.triangles.empty()) deliver(part);
            }
            // Only the upper edge of a row of tiles will be met again.
            std::erase_if(border_, [&](const auto& entry) { return std::bit_cast<float>(entry.first.bits[1]) < y + t - shared; });
        }
        if (measured_area_ > 0.0) report_.mean_error /= measured_area_;
        return report_;
    }

private:
    struct Blocks {
        std::vector<LatticeBlock> sampled;
        std::vector<std::array<int, 3>> solid;
    };
    struct Placed {
        std::uint32_t index;
        Vec3d position;
        bool on_surface = false;
    };
    using Places = std::unordered_map<Key, std::int64_t, KeyHash>;

    Vec3d at(double i, double j, double k) const { return options_.region.min + Vec3d(i, j, k) * h_; }

    /// Descends from the box of blocks [lo, hi). A block counts as crossed if the field may change its sign within it or one step around.
    void find_blocks(const std::array<int, 3>& lo, const std::array<int, 3>& hi, Blocks& out) const
    {
        const Interval range =
            field_.range(Box3d(at(lo[0] * block - 1, lo[1] * block - 1, lo[2] * block - 1), at(hi[0] * block, hi[1] * block, hi[2] * block)));
        if (range.lo > 0.0) return;
        if (range.hi < 0.0) {
            for (int x = lo[0]; x < hi[0]; ++x)
                for (int y = lo[1]; y < hi[1]; ++y)
                    for (int z = lo[2]; z < hi[2]; ++z) out.solid.push_back({x * block, y * block, z * block});
            return;
        }
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
        if (hi[axis] - lo[axis] == 1) {
            out.sampled.emplace_back().corner = {lo[0] * block, lo[1] * block, lo[2] * block};
            return;
        }
        auto below = hi, above = lo;
        below[axis] = above[axis] = (lo[axis] + hi[axis]) / 2;
        find_blocks(lo, below, out);
        find_blocks(above, hi, out);
    }

    Blocks sample(int x, int y) const
    {
        const auto past = [&](int axis, int i) { return (std::min(i, size_[axis]) + margin) / block + 1; };
        Blocks blocks;
        find_blocks({(x - margin) / block, (y - margin) / block, -1}, {past(0, x + options_.tile), past(1, y + options_.tile), past(2, size_[2])},
                    blocks);
        parallel_items(blocks.sampled.size(), [&](std::size_t n) {
            LatticeBlock& b = blocks.sampled[n];
            for (int v = 0; v < 512; ++v)
                b.values[static_cast<std::size_t>(v)] =
                    static_cast<float>(field_.value(at(b.corner[0] + (v >> 6), b.corner[1] + (v >> 3 & 7), b.corner[2] + (v & 7))));
        });
        return blocks;
    }

    /// Whether the centre of the quadrilateral, in lattice units, is this tile's and the region's.
    bool owns(int x, int y, const LatticeMesh& mesh, std::array<std::uint32_t, 4> quad) const
    {
        // Sorted, so that the sum does not depend on where a tile's polygon begins.
        const auto middle = [&](int axis) {
            std::array<float, 4> c;
            for (std::size_t k = 0; k < 4; ++k) c[k] = mesh.points[quad[k]][axis];
            std::sort(c.begin(), c.end());
            return 0.25 * (static_cast<double>(c[0]) + c[1] + c[2] + c[3]);
        };
        // The lowest and highest samples end in what the polygoniser takes for air: that face is none.
        const double u = middle(0), v = middle(1), w = options_.tile, z = middle(2);
        if (z < -2.0 || z > size_[2] + 2.0) return false;
        const Vec3d extent = options_.region.max - options_.region.min;
        return u >= x && u < x + w && v >= y && v < y + w && u * h_ <= extent.x && v * h_ <= extent.y;
    }

    MeshPart make_tile(int x, int y)
    {
        const Blocks blocks = sample(x, y);
        if (blocks.sampled.empty()) return {};
        const LatticeMesh mesh = lattice_surface(blocks.sampled, blocks.solid);
        MeshPart part;
        std::vector<std::array<std::uint32_t, 4>> quads;
        std::vector<std::int64_t> placed(mesh.points.size(), -1);  // a point's place in `all`
        std::vector<Placed> all;
        std::vector<std::pair<std::size_t, Key>> fresh;  // places in `all` that are new, in order
        Places places;
        for (const auto& quad : mesh.quads) {
            if (!owns(x, y, mesh, quad)) continue;
            quads.push_back(quad);
            for (std::uint32_t& corner : quads.back()) {
                if (placed[corner] < 0) placed[corner] = place_point(mesh.points[corner], all, fresh, places);
                corner = static_cast<std::uint32_t>(placed[corner]);
            }
        }
        refine(all, fresh, part);
        for (const auto& [place, key] : fresh)
            if (near_edge(x, y, key)) border_.emplace(key, all[place]);
        cut_quads(all, quads, part);
        measure(all, quads, part);
        return part;
    }

    /// Whether a neighbour may share the point.
    bool near_edge(int x, int y, const Key& key) const
    {
        const auto near = [&](std::uint32_t bits, int from) {
            const double u = std::bit_cast<float>(bits);
            return u < from + shared || u > from + options_.tile - shared;
        };
        return near(key.bits[0], x) || near(key.bits[1], y);
    }

    /// Where the point goes in `all`. Equal points are one, even if the polygoniser made two of them: between tiles nobody could tell them apart.
    std::int64_t place_point(const Vec3f& p, std::vector<Placed>& all, std::vector<std::pair<std::size_t, Key>>& fresh, Places& places) const
    {
        const Key key = key_of(p);
        const auto place = static_cast<std::int64_t>(all.size());
        if (const auto [same, is_new] = places.emplace(key, place); !is_new) return same->second;
        if (const auto known = border_.find(key); known != border_.end()) {
            all.push_back(known->second);
        } else {
            fresh.emplace_back(all.size(), key);
            all.push_back({0, at(p.x, p.y, p.z)});
        }
        return place;
    }

    /// Moves the new vertices onto the surface and numbers them.
    void refine(std::vector<Placed>& all, const std::vector<std::pair<std::size_t, Key>>& fresh, MeshPart& part)
    {
        if (report_.vertices + fresh.size() > 0x7fffffffu)
            throw Error(ErrorKind::scene, Problem{{}, "the mesh is too large", "at most 2147483647 vertices: a wider spacing", {}, {}});
        part.vertices.resize(fresh.size());
        part.normals.resize(fresh.size());
        std::vector<std::uint8_t> failed(fresh.size(), 0);
        parallel_items((fresh.size() + 255) / 256, [&](std::size_t chunk) {
            for (std::size_t n = 256 * chunk; n < std::min(fresh.size(), 256 * chunk + 256); ++n) {
                Vec3d& p = all[fresh[n].first].position;
                failed[n] = !place(p, part.normals[n]);
                all[fresh[n].first].on_surface = !failed[n];
                part.vertices[n] = p;
            }
        });
        for (const std::uint8_t f : failed) report_.unrefined += f;
        for (const auto& [place, key] : fresh) all[place].index = static_cast<std::uint32_t>(report_.vertices++);
    }

    /// To the root nearest along the gradient; a vertex on a side of the region stays in that side.
    bool place(Vec3d& p, Vec3d& normal) const
    {
        std::array<bool, 3> held{};
        for (int k = 0; k < 2; ++k) {
            const double inside = std::clamp(p[k], options_.region.min[k], options_.region.max[k]);
            held[k] = inside != p[k];
            p[k] = inside;
        }
        Vec3d n = field_.gradient(p);
        for (int k = 0; k < 2; ++k)
            if (held[k]) n[k] = 0.0;
        const double slope = n.length();
        bool found = false;
        if (slope > 0.0) {
            n /= slope;
            if (const auto distance = root_along(field_, p, n, field_.value(p), slope, h_)) {
                p += n * *distance;
                found = true;
            }
        }
        normal = field_.gradient(p);
        normal = normal.length() > 0.0 ? normal.normalized() : slope > 0.0 ? n : Vec3d(0, 0, 1);
        return found;
    }

    static void cut_quads(const std::vector<Placed>& all, const std::vector<std::array<std::uint32_t, 4>>& quads, MeshPart& part)
    {
        for (const auto& q : quads) {
            const auto p = [&](int k) { return all[q[static_cast<std::size_t>(k)]].position; };
            const auto add = [&](int a, int b, int c) {
                const std::array<std::uint32_t, 3> t{all[q[a]].index, all[q[b]].index, all[q[c]].index};
                if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) part.triangles.push_back(t);
            };
            const bool first = (p(2) - p(0)).length2() <= (p(3) - p(1)).length2();
            add(0, 1, first ? 2 : 3);
            add(first ? 0 : 1, 2, 3);
        }
    }

    /// Length of a way from p, a place on the triangle, to the field's zero; infinite if none was found.
    double way_to_surface(const Vec3d& p, const std::array<const Placed*, 3>& corners) const
    {
        const double value = field_.value(p);
        const auto along = [&](Vec3d direction, double slope, double reach) {
            if (!(direction.length() > 0.0)) return kInfinity;
            const auto found = root_along(field_, p, direction.normalized(), value, slope, reach);
            return found ? std::abs(*found) : kInfinity;
        };
        const Vec3d gradient = field_.gradient(p);
        const Vec3d normal = (corners[1]->position - corners[0]->position).cross(corners[2]->position - corners[0]->position);
        double way = along(gradient, gradient.length(), 2.0 * h_);
        if (way == kInfinity) way = along(normal, kInfinity, 2.0 * h_);
        if (way < kInfinity) return way;
        for (const Placed* corner : corners)
            if (corner->on_surface) way = std::min(way, (p - corner->position).length());
        const double most = options_.region.size().length();
        for (double reach = 4.0 * h_; way == kInfinity && reach < 2.0 * most; reach *= 2.0)
            way = std::min(along(gradient, gradient.length(), reach), along(normal, kInfinity, reach));
        return way;
    }

    void measure(const std::vector<Placed>& all, const std::vector<std::array<std::uint32_t, 4>>& quads, const MeshPart& part)
    {
        std::unordered_map<std::uint32_t, const Placed*> known;
        for (const auto& quad : quads)
            for (const std::uint32_t corner : quad) known.emplace(all[corner].index, &all[corner]);
        struct Measured {
            double area, mean, maximum;
        };
        std::vector<Measured> measured(part.triangles.size());
        parallel_items((measured.size() + 255) / 256, [&](std::size_t chunk) {
            for (std::size_t n = 256 * chunk; n < std::min(measured.size(), 256 * chunk + 256); ++n) {
                const auto& t = part.triangles[n];
                const std::array<const Placed*, 3> corners{known.at(t[0]), known.at(t[1]), known.at(t[2])};
                const Vec3d &a = corners[0]->position, &b = corners[1]->position, &c = corners[2]->position;
                Measured m{0.5 * (b - a).cross(c - a).length(), 0.0, 0.0};
                for (const Vec3d& p : {(a + b + c) / 3.0, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5}) {
                    const double way = way_to_surface(p, corners);
                    m.mean += 0.25 * way;
                    m.maximum = std::max(m.maximum, way);
                }
                measured[n] = m;
            }
        });
        for (const Measured& m : measured) {
            report_.area += m.area;
            if (m.maximum == kInfinity) {
                ++report_.far_triangles;
                continue;
            }
            report_.mean_error += m.area * m.mean;
            measured_area_ += m.area;
            report_.maximum_error = std::max(report_.maximum_error, m.maximum);
        }
        report_.triangles += part.triangles.size();
    }

    const Field& field_;
    const PolygoniseOptions& options_;
    double h_;
    std::array<int, 3> size_{};
    std::unordered_map<Key, Placed, KeyHash> border_;
    PolygoniseReport report_;
    double measured_area_ = 0.0;
};

}  // namespace

double distance_along_gradient(const Field& field, const Vec3d& p, double reach)
{
    const Vec3d gradient = field.gradient(p);
    const double slope = gradient.length();
    if (!(slope > 0.0)) return reach;
    const auto found = root_along(field, p, gradient / slope, field.value(p), slope, reach);
    return found ? std::abs(*found) : reach;
}

PolygoniseReport polygonise(const Field& field, const PolygoniseOptions& options, const std::function<void(const MeshPart&)>& deliver)
{
    return Polygoniser(field, options).run(deliver);
}

}  // namespace hoodoo
