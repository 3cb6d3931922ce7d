// Voronoi cells by clipping a large square with every bisector; a ray is in a crack where it is in the stadium around an edge; heights are marched
// with steps that their slope bound allows.
#include "tests/support/crack_oracle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

namespace hoodoo::testing
{

std::vector<Vec2d> golden_sites(int n)
{
    std::uint32_t x = 12345;
    const auto next = [&] {
        x = x * 1664525u + 1013904223u;
        return (x >> 8) / 16777216.0;
    };
    std::vector<Vec2d> sites;
    for (int k = 0; k < n; ++k) {
        const double u = next();
        sites.emplace_back(u, next());
    }
    return sites;
}

namespace
{

/// Where origin + t direction is within `radius` of the segment, as an interval; nothing if nowhere. A stadium is convex, so it is one interval: from
/// the ends' discs and the strip between them the least and the largest parameter.
std::optional<Vec2d> in_stadium(const Vec2d& origin, const Vec2d& direction, const CrackOracle::Edge& edge, double radius)
{
    double lo = kInfinity, hi = -kInfinity;
    const auto take = [&](double s, double t) { lo = std::min(lo, s), hi = std::max(hi, t); };
    for (const Vec2d& centre : {edge.a, edge.b}) {
        const Vec2d from = origin - centre;
        const double a = direction.length2(), b = from.dot(direction), c = from.length2() - radius * radius, root = b * b - a * c;
        if (root >= 0.0) take((-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a);
    }
    const double length = (edge.b - edge.a).length();
    const Vec2d along = (edge.b - edge.a) / length, across(-along.y, along.x);
    double s = -kInfinity, t = kInfinity;
    const auto slab = [&](double place, double rate, double low, double high) {
        if (rate == 0.0) {
            if (place < low || place > high) s = kInfinity;
            return;
        }
        s = std::max(s, std::min((low - place) / rate, (high - place) / rate));
        t = std::min(t, std::max((low - place) / rate, (high - place) / rate));
    };
    slab((origin - edge.a).dot(along), direction.dot(along), 0.0, length);
    slab((origin - edge.a).dot(across), direction.dot(across), -radius, radius);
    if (s < t) take(s, t);
    return lo < hi ? std::optional(Vec2d(lo, hi)) : std::nullopt;
}

}  // namespace

CrackOracle::CrackOracle(std::vector<Vec2d> sites, const Parameters& parameters, std::function<double(const Vec2d&)> height)
    : p_(parameters), height_(std::move(height))
{
    for (std::size_t i = 0; i < sites.size(); ++i) {
        // The cell's corners, each with the site across the side that follows it.
        constexpr std::size_t outside = ~std::size_t{0};
        std::vector<std::pair<Vec2d, std::size_t>> cell{{{-3, -3}, outside}, {{4, -3}, outside}, {{4, 4}, outside}, {{-3, 4}, outside}};
        for (std::size_t j = 0; j < sites.size(); ++j) {
            if (j == i) continue;
            const Vec2d middle = (sites[i] + sites[j]) * 0.5, across = sites[j] - sites[i];
            std::vector<std::pair<Vec2d, std::size_t>> cut;
            for (std::size_t k = 0; k < cell.size(); ++k) {
                const auto& [a, side] = cell[k];
                const Vec2d b = cell[(k + 1) % cell.size()].first;
                const double da = across.dot(a - middle), db = across.dot(b - middle);
                if (da <= 0.0) cut.emplace_back(a, side);
                if ((da <= 0.0) != (db <= 0.0)) cut.emplace_back(a + (b - a) * (da / (da - db)), da <= 0.0 ? j : side);
            }
            cell = std::move(cut);
        }
        for (std::size_t k = 0; k < cell.size(); ++k)
            if (cell[k].second != outside && cell[k].second > i) edges_.push_back({cell[k].first, cell[(k + 1) % cell.size()].first});
    }
    std::erase_if(edges_, [](const Edge& e) { return !((e.b - e.a).length() > 0.0); });
}

const CrackOracle::Edge& CrackOracle::nearest(const Vec2d& p) const
{
    const auto zeta = [&](const Edge& e) {
        const Vec2d along = e.b - e.a;
        const double t = std::clamp((p - e.a).dot(along) / along.length2(), 0.0, 1.0);
        return (p - e.a - along * t).length();
    };
    return *std::min_element(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) { return zeta(a) < zeta(b); });
}

double CrackOracle::distance(const Vec2d& p) const
{
    const Edge& e = nearest(p);
    const Vec2d along = e.b - e.a;
    return (p - e.a - along * std::clamp((p - e.a).dot(along) / along.length2(), 0.0, 1.0)).length();
}

double CrackOracle::iota(double h) const
{
    if (h <= p_.psi) return 1.0;
    const double d = std::abs(h - p_.psi);
    return d >= p_.epsilon ? 0.0 : 1.0 - d / p_.epsilon;
}

double CrackOracle::cracked_height(const Vec2d& p) const
{
    const double h = height_(p), aleph = distance(p) <= 0.5 * p_.width ? 1.0 : 0.0;
    return (1.0 - p_.kappa * iota(h) * aleph) * h;
}

std::vector<CrackOracle::Stretch> CrackOracle::stretches(const Ray& ray) const
{
    double from = ray.t_min, to = std::min(ray.t_max, 1e3);
    for (int k = 0; k < 2; ++k) {
        const double d = ray.direction[k], o = ray.origin[k];
        if (d == 0.0) {
            if (o < 0.0 || o > 1.0) return {};
            continue;
        }
        from = std::max(from, std::min((0.0 - o) / d, (1.0 - o) / d));
        to = std::min(to, std::max((0.0 - o) / d, (1.0 - o) / d));
    }
    // Heights are between 0 and 1 (and more than a tenth below 1).
    for (const double z : {-0.1, 1.1}) {
        if (ray.direction.z == 0.0) continue;
        const double t = (z - ray.origin.z) / ray.direction.z;
        if ((z < 0.0) == (ray.direction.z < 0.0))
            to = std::min(to, t);
        else
            from = std::max(from, t);
    }
    if (!(from < to)) return {};

    const Vec2d origin(ray.origin.x, ray.origin.y), direction(ray.direction.x, ray.direction.y);
    std::vector<Vec2d> torn;
    if (direction.length() > 1e-9) {
        for (const Edge& edge : edges_)
            if (const auto piece = in_stadium(origin, direction, edge, 0.5 * p_.width))
                if (piece->y > from && piece->x < to) torn.push_back(*piece);
    } else if (distance(origin) <= 0.5 * p_.width) {
        torn.emplace_back(from, to);
    }
    std::sort(torn.begin(), torn.end(), [](const Vec2d& a, const Vec2d& b) { return a.x < b.x; });
    std::vector<Stretch> found;
    double at = from;
    for (const Vec2d& piece : torn) {
        const double begin = std::clamp(piece.x, at, to), end = std::clamp(piece.y, at, to);
        if (begin > at) found.push_back({at, begin, false});
        if (end > begin) {
            if (!found.empty() && found.back().cracked && begin == found.back().to)
                found.back().to = end;
            else
                found.push_back({begin, end, true});
        }
        at = std::max(at, end);
    }
    if (at < to) found.push_back({at, to, false});
    return found;
}

std::string CrackOracle::judge(const Ray& ray, double t, double margin) const
{
    const std::vector<Stretch> all = stretches(ray);
    const auto value = [&](double s, bool cracked) {
        const Vec3d p = ray.at(s);
        const double h = height_({p.x, p.y});
        return p.z - (cracked ? (1.0 - p_.kappa * iota(h)) * h : h);
    };
    std::ostringstream out;
    out.precision(17);
    // The floor is steeper than the ground by at most 1 + kappa (psi + epsilon) / epsilon.
    const double flat = std::hypot(ray.direction.x, ray.direction.y);
    const double steepest = p_.steepest * (1.0 + p_.kappa * (p_.psi + p_.epsilon) / p_.epsilon) * flat + std::abs(ray.direction.z);

    // A hit is one: on a stretch z = h' there, or at an end of a stretch the two sides disagree, or nearly.
    if (std::isfinite(t)) {
        const double allowed = margin * (1.0 + steepest);
        bool good = all.empty();  // at the rim of the square
        for (std::size_t k = 0; k < all.size(); ++k) {
            const Stretch& s = all[k];
            if (t >= s.from - margin && t <= s.to + margin && std::abs(value(t, s.cracked)) <= allowed) good = true;
            if (k > 0 && std::abs(t - s.from) <= margin && value(t, true) >= -allowed && value(t, false) <= allowed) good = true;
        }
        if (!all.empty() && (t < all.front().from + 1e-6 || t > all.back().to - 1e-6)) good = true;
        if (!good) {
            out << "false hit at " << t << " of " << ray.origin << " along " << ray.direction;
            return out.str();
        }
    }

    enum { unknown, air, matter } side = unknown;
    for (const Stretch& s : all) {
        for (double at = s.from;;) {
            const double f = value(at, s.cracked);
            if (std::abs(f) > margin) {
                const auto now = f < 0.0 ? matter : air;
                if (side != unknown && side != now && (now == matter || ray.crossing == Crossing::any)) {
                    if (t > at + margin) {
                        out << "a crossing before " << at << " was missed, reported " << t << ", of " << ray.origin << " along " << ray.direction;
                        return out.str();
                    }
                    return {};
                }
                side = now;
            }
            if (at >= s.to || at > t + margin) break;
            at = std::min(s.to, at + std::max(std::abs(f) / steepest, 1e-5));
        }
    }
    return {};
}

}  // namespace hoodoo::testing
