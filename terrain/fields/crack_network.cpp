// Cracks are bands along the borders of a Voronoi diagram (Li2023, equations 1 to 6), all answers in closed form.
//   aleph(p) = 1 where d(p) <= width / 2                                 (4), d the distance to the borders' segments (5, 6; see voronoi.cpp)
//   h' = (1 - kappa iota(h) aleph) h                                     (1)
//   iota = 1 for h <= psi, 1 - (h - psi) / epsilon down to 0 above       (2, 3)
// Inside one cell the ground without cracks is the cell moved in by half a width: convex, so a straight path has one stretch of it in each cell, and
// its ends are quotients of two numbers that belong to one border. Deviations. The paper's lambda is a width in the unit square; with its defaults
// (lambda = 0.1, n = 200) it would crack 98 % of the ground, so widths are made from lambda by the caller in units of the mean spacing. (6) as
// printed is the distance to the endless line, which would crack 97 %: the text's segment is meant. Borders of the rectangle are no cracks. Missing:
// soft edges (aleph is 0 or 1, walls are vertical).
#include "terrain/fields/crack_network.h"

#include "terrain/math/hash.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// Sites so far, in a grid of cells about as wide as their mean distance in the end.
class SiteGrid
{
public:
    SiteGrid(const Box2d& box, int n) : box_(box)
    {
        const Vec2d size = box.size();
        side_ = std::sqrt(size.x * size.y / n);
        nx_ = static_cast<int>(std::clamp(std::ceil(size.x / side_), 1.0, 4096.0));
        ny_ = static_cast<int>(std::clamp(std::ceil(size.y / side_), 1.0, 4096.0));
        side_ = std::max(size.x / nx_, size.y / ny_);
        cells_.resize(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
    }

    void add(const Vec2d& p) { cells_[index(column(p), row(p))].push_back(p); }

    /// Squared distance to the nearest one; infinite without any.
    double nearest2(const Vec2d& p) const
    {
        double least = kInfinity;
        const int cx = column(p), cy = row(p);
        for (int ring = 0; ring <= std::max(nx_, ny_); ++ring) {
            // Cells beyond this ring are at least (ring - 1) of the narrower sides away.
            const double reach = std::max(0, ring - 1) * std::min(box_.size().x / nx_, box_.size().y / ny_);
            if (reach * reach > least) break;
            for (int j = std::max(0, cy - ring); j <= std::min(ny_ - 1, cy + ring); ++j) {
                const bool whole = j == cy - ring || j == cy + ring;
                for (int i = cx - ring; i <= cx + ring; i += whole || ring == 0 ? 1 : 2 * ring) {
                    if (i < 0 || i >= nx_) continue;
                    for (const Vec2d& q : cells_[index(i, j)]) least = std::min(least, (p - q).length2());
                }
            }
        }
        return least;
    }

private:
    int column(const Vec2d& p) const { return std::clamp(static_cast<int>((p.x - box_.min.x) / box_.size().x * nx_), 0, nx_ - 1); }
    int row(const Vec2d& p) const { return std::clamp(static_cast<int>((p.y - box_.min.y) / box_.size().y * ny_), 0, ny_ - 1); }
    std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i); }

    Box2d box_;
    double side_ = 1.0;
    int nx_ = 1, ny_ = 1;
    std::vector<std::vector<Vec2d>> cells_;
};

}  // namespace

Box2d crack_box(int n, const Box2d& area)
{
    const Vec2d size = area.size();
    const Vec2d rim(kCrackRim * std::sqrt(size.x * size.y / n));
    return {area.min - rim, area.max + rim};
}

std::vector<Vec2d> crack_sites(std::uint64_t seed, int n, const Box2d& area, SiteKind kind)
{
    const Box2d box = crack_box(n, area);
    const auto rim = static_cast<int>(std::lround(n * (box.size().x * box.size().y / (area.size().x * area.size().y) - 1.0)));
    // Mitchell's best candidate (Mitchell1991), of one where they are independent.
    const int attempts = kind == SiteKind::even ? 16 : 1;
    SiteGrid grid(box, n);
    std::vector<Vec2d> sites;
    const auto place = [&](const auto& draw) {
        Vec2d best = draw(0);
        double farthest = kind == SiteKind::even ? grid.nearest2(best) : 0.0;
        for (int attempt = 1; attempt < attempts; ++attempt) {
            const Vec2d p = draw(attempt);
            const double d = grid.nearest2(p);
            if (d > farthest) farthest = d, best = p;
        }
        grid.add(sites.emplace_back(best));
    };
    const auto uniform = [](std::uint64_t h, const Box2d& within) {
        return within.min + Vec2d(unit_real(hash_cell(h, 0, 0)), unit_real(hash_cell(h, 1, 0))) * within.size();
    };
    for (int k = 0; k < n; ++k) place([&](int attempt) { return uniform(hash_cell(seed, k, attempt, 0), area); });
    for (int k = 0; k < rim; ++k) {
        place([&](int attempt) {
            // Drawn until outside of the area; a rim is there, so it ends.
            for (std::int64_t again = 0;; ++again) {
                const Vec2d p = uniform(hash_combine(hash_cell(seed, k, attempt, 1), static_cast<std::uint64_t>(again)), box);
                if (!area.intersects(p)) return p;
            }
        });
    }
    return sites;
}

CrackNetwork::CrackNetwork(VoronoiDiagram diagram, double width) : diagram_(std::move(diagram)), width_(width) {}

Interval CrackNetwork::distance_range(const Box2d& box) const
{
    const double d = distance((box.min + box.max) * 0.5), reach = 0.5 * box.size().length();
    return {std::max(0.0, d - reach), d + reach};
}

Vec2d CrackNetwork::towards(const Vec2d& p) const
{
    const VoronoiDiagram::Border* nearest = nullptr;
    for (const VoronoiDiagram::Border& border : diagram_.borders(diagram_.nearest(p)))
        if (!nearest || border.distance(p) < nearest->distance(p)) nearest = &border;
    return nearest ? nearest->normal : Vec2d(1.0, 0.0);
}

CrackNetwork::Crossing CrackNetwork::cross(std::uint32_t site, const Vec2d& origin, const Vec2d& direction) const
{
    Crossing c;
    const double half = 0.5 * width_;
    bool clear = true;
    for (const VoronoiDiagram::Border& border : diagram_.borders(site)) {
        // The distance to this border along the path is room - rate t.
        const double rate = border.normal.dot(direction), room = border.distance(origin);
        if (rate == 0.0) {
            clear = clear && room > half;
            continue;
        }
        const double at = (room - half) / rate;
        if (rate > 0.0) {
            if (at < c.leave) c.leave = at, c.leave_normal = border.normal;
            const double end = room / rate;
            if (end < c.end) c.end = end, c.next = border.neighbour;
        } else if (at > c.enter) {
            c.enter = at, c.enter_normal = border.normal;
        }
    }
    if (!clear) c.enter = kInfinity, c.leave = -kInfinity;
    return c;
}

double CrackDepth::iota(double h) const
{
    if (h <= psi) return 1.0;
    const double d = h - psi;
    return d >= epsilon ? 0.0 : 1.0 - d / epsilon;
}

double CrackDepth::floor(double h) const
{
    return h > 0.0 ? (1.0 - kappa * iota(h)) * h : h;
}

double CrackDepth::ground(double z) const
{
    if (z <= 0.0 || z >= psi + epsilon) return z;
    if (z <= (1.0 - kappa) * psi) return z / (1.0 - kappa);
    if (epsilon == 0.0) return psi;
    // (1 - kappa + kappa (h - psi) / epsilon) h = z: the positive root of a h^2 + b h = z, in the form that does not cancel for b > 0.
    const double a = kappa / epsilon, b = 1.0 - kappa - kappa * psi / epsilon;
    const double root = std::sqrt(b * b + 4.0 * a * z);
    return b >= 0.0 ? 2.0 * z / (b + root) : (root - b) / (2.0 * a);
}

double CrackDepth::ground_slope(double z) const
{
    if (z < 0.0 || z >= psi + epsilon) return 1.0;
    if (z < (1.0 - kappa) * psi) return 1.0 / (1.0 - kappa);
    if (epsilon == 0.0) return 0.0;
    const double a = kappa / epsilon, b = 1.0 - kappa - kappa * psi / epsilon;
    return 1.0 / std::sqrt(b * b + 4.0 * a * z);
}

double CrackDepth::ground_bend(const Interval& z) const
{
    const double middle = 0.5 * (z.lo + z.hi);
    if (epsilon == 0.0 || middle <= (1.0 - kappa) * psi || middle >= psi + epsilon) return 0.0;
    // The second derivative of the root above is -2a / (b^2 + 4 a z)^(3/2): largest at the lower end, where at z = (1 - kappa) psi the base is
    // (1 - kappa + kappa psi / epsilon)^2 > 0.
    const double a = kappa / epsilon, b = 1.0 - kappa - kappa * psi / epsilon;
    const double base = b * b + 4.0 * a * std::max(z.lo, (1.0 - kappa) * psi);
    return 2.0 * a / (base * std::sqrt(base)) * (1.0 + 1e-9);
}

}  // namespace hoodoo
