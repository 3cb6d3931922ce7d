// Arcs are splines through their nodes; frames are carried along them with two reflections a step.
//
// Peytavie2009, section 4.2 (after Desbenoit2005) sweeps along the arcs of a graph. CHOICES: arcs are centripetal Catmull-Rom curves (Catmull1974,
// Yuksel2011: no loops between unevenly spaced nodes); frames are rotation-minimising by double reflection (Wang2008): reflect the frame in the plane
// between two steps, then in the plane that brings the reflected tangent onto the new one. Error of fourth order in the step.
// Crossings are looked for between straight pieces, eight to a span of nodes. Missing: a proof that curves do not cross between those.
#include "terrain/edit/skeleton.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// Centripetal Catmull-Rom between b and c, by the pyramid of Barry and Goldman (Yuksel2011): knots a half-power of the distance apart.
Vec3d centripetal(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, double u)
{
    const auto gap = [](const Vec3d& p, const Vec3d& q) { return std::max(std::sqrt((q - p).length()), 1e-12); };
    const double t0 = 0.0, t1 = t0 + gap(a, b), t2 = t1 + gap(b, c), t3 = t2 + gap(c, d), t = t1 + u * (t2 - t1);
    const auto mix = [t](const Vec3d& p, double from, const Vec3d& q, double to) { return (p * (to - t) + q * (t - from)) / (to - from); };
    const Vec3d ab = mix(a, t0, b, t1), bc = mix(b, t1, c, t2), cd = mix(c, t2, d, t3);
    return mix(mix(ab, t0, bc, t2), t1, mix(bc, t1, cd, t3), t2);
}

/// The place at `u` between the arc's nodes k and k + 1.
Vec3d place(const Skeleton& skeleton, const std::vector<std::size_t>& arc, std::size_t k, double u, bool smooth)
{
    const Vec3d &b = skeleton.nodes[arc[k]], &c = skeleton.nodes[arc[k + 1]];
    if (u <= 0.0) return b;
    if (u >= 1.0) return c;
    if (!smooth) return b + (c - b) * u;
    // Beyond its ends an arc goes on as its own mirror image; one that returns to its first node goes round.
    const bool closed = arc.size() > 3 && arc.front() == arc.back();
    const Vec3d a = k > 0 ? skeleton.nodes[arc[k - 1]] : closed ? skeleton.nodes[arc[arc.size() - 2]] : b * 2.0 - c;
    const Vec3d d = k + 2 < arc.size() ? skeleton.nodes[arc[k + 2]] : closed ? skeleton.nodes[arc[1]] : c * 2.0 - b;
    return centripetal(a, b, c, d, u);
}

void find_tangents(SkeletonPath& path)
{
    for (std::size_t k = 0; k < path.size(); ++k) {
        const Vec3d chord = path[std::min(k + 1, path.size() - 1)].at - path[k > 0 ? k - 1 : 0].at;
        path[k].tangent = chord.length() > 0.0 ? chord.normalized() : k > 0 ? path[k - 1].tangent : Vec3d(1, 0, 0);
    }
}

/// The part of `wanted` across the tangent; any direction across it if there is none.
Vec3d across(const Vec3d& tangent, const Vec3d& wanted, const Vec3d& otherwise)
{
    const Vec3d n = wanted - tangent * wanted.dot(tangent);
    if (n.length() > 1e-3 * wanted.length()) return n.normalized();
    const Vec3d m = otherwise - tangent * otherwise.dot(tangent);
    if (m.length() > 1e-6) return m.normalized();
    Vec3d first, second;
    orthonormal_frame(tangent, first, second);
    return first;
}

Vec3d carried(const SkeletonStep& from, const SkeletonStep& to)
{
    // Wang2008, figure 5 of the method: r_L = r - 2/c1 (v1.r) v1, t_L likewise, then the same in v2 = t_next - t_L.
    const Vec3d v1 = to.at - from.at;
    const double c1 = v1.dot(v1);
    if (!(c1 > 0.0)) return across(to.tangent, from.normal, from.tangent);
    const Vec3d r = from.normal - v1 * (2.0 / c1 * v1.dot(from.normal)), t = from.tangent - v1 * (2.0 / c1 * v1.dot(from.tangent));
    const Vec3d v2 = to.tangent - t;
    const double c2 = v2.dot(v2);
    return across(to.tangent, c2 > 0.0 ? r - v2 * (2.0 / c2 * v2.dot(r)) : r, from.normal);
}

struct Piece {
    Vec3d a, b;  ///< seen along the projection
    std::size_t arc;
    std::size_t from, to;       ///< nodes it begins and ends at; npos inside a span
    double low, high;           ///< along x
    std::size_t before, after;  ///< neighbours along the same arc, by number; npos
};

constexpr std::size_t npos = static_cast<std::size_t>(-1);

/// Nearest points of two straight pieces; returns their distance and the place on the first.
double distance(const Piece& p, const Piece& q, Vec3d& at)
{
    const Vec3d u = p.b - p.a, v = q.b - q.a, w = p.a - q.a;
    const double a = u.dot(u), b = u.dot(v), c = v.dot(v), d = u.dot(w), e = v.dot(w), det = a * c - b * b;
    double best = kInfinity;
    const auto look = [&](double s, double t) {
        const Vec3d x = p.a + u * s, y = q.a + v * t;
        if ((x - y).length() < best) best = (x - y).length(), at = x;
    };
    const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
    if (det > 1e-12 * a * c) {
        const double s = (b * e - c * d) / det, t = (a * e - b * d) / det;
        if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) look(s, t);
    }
    // Otherwise one of them at an end.
    for (const double s : {0.0, 1.0}) look(s, c > 0.0 ? unit((e + s * b) / c) : 0.0);
    for (const double t : {0.0, 1.0}) look(a > 0.0 ? unit((t * b - d) / a) : 0.0, t);
    return best;
}

std::vector<Piece> pieces_of(const Skeleton& skeleton, bool smooth, const std::optional<Vec3d>& along)
{
    constexpr int parts = 8;
    const auto seen = [&](const Vec3d& p) { return along ? p - *along * p.dot(*along) : p; };
    std::vector<Piece> pieces;
    for (std::size_t a = 0; a < skeleton.arcs.size(); ++a) {
        const auto& arc = skeleton.arcs[a];
        for (std::size_t k = 0; k + 1 < arc.size(); ++k) {
            for (int n = 0; n < parts; ++n) {
                Piece piece{seen(place(skeleton, arc, k, static_cast<double>(n) / parts, smooth)),
                            seen(place(skeleton, arc, k, (n + 1.0) / parts, smooth)),
                            a,
                            n == 0 ? arc[k] : npos,
                            n + 1 == parts ? arc[k + 1] : npos,
                            0.0,
                            0.0,
                            npos,
                            npos};
                piece.low = std::min(piece.a.x, piece.b.x), piece.high = std::max(piece.a.x, piece.b.x);
                const std::size_t number = pieces.size();
                if (k > 0 || n > 0) piece.before = number - 1, pieces.back().after = number;
                pieces.push_back(piece);
            }
        }
    }
    return pieces;
}

/// Pieces that follow one another, or leave the same node, touch by right unless they run back over one another.
bool may_touch(const Piece& p, const Piece& q, std::size_t q_number)
{
    const auto opens = [](const Vec3d& u, const Vec3d& v) { return u.dot(v) < (1.0 - 1e-9) * u.length() * v.length(); };
    if (p.after == q_number) return opens(p.a - p.b, q.b - q.a);
    if (p.before == q_number) return opens(q.a - q.b, p.b - p.a);
    const auto same = [](std::size_t a, std::size_t b) { return a != npos && a == b; };
    if (same(p.from, q.from)) return opens(p.b - p.a, q.b - q.a);
    if (same(p.to, q.to)) return opens(p.a - p.b, q.a - q.b);
    if (same(p.from, q.to)) return opens(p.b - p.a, q.a - q.b);
    if (same(p.to, q.from)) return opens(p.a - p.b, q.b - q.a);
    return false;
}

}  // namespace

SkeletonPath arc_steps(const Skeleton& skeleton, std::size_t arc, double step, bool smooth)
{
    const auto& nodes = skeleton.arcs[arc];
    SkeletonPath path;
    if (nodes.size() == 1) path.push_back({skeleton.nodes[nodes[0]], 0.0, Vec3d(0.0), Vec3d(0.0)});
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
        const double length = (skeleton.nodes[nodes[k + 1]] - skeleton.nodes[nodes[k]]).length();
        const int count = std::max(1, static_cast<int>(std::ceil(length / step)));
        for (int n = k == 0 ? 0 : 1; n <= count; ++n) {
            SkeletonStep s;
            s.at = place(skeleton, nodes, k, static_cast<double>(n) / count, smooth);
            s.node = static_cast<double>(k) + static_cast<double>(n) / count;
            path.push_back(s);
        }
    }
    return path;
}

void frame_minimally(SkeletonPath& path, const Vec3d& first)
{
    find_tangents(path);
    for (std::size_t k = 0; k < path.size(); ++k) {
        path[k].normal = k == 0 ? across(path[0].tangent, first, Vec3d(1, 0, 0)) : carried(path[k - 1], path[k]);
    }
}

void frame_towards(SkeletonPath& path, const std::vector<Vec3d>& wanted)
{
    find_tangents(path);
    for (std::size_t k = 0; k < path.size(); ++k) {
        path[k].normal = across(path[k].tangent, wanted[k], k == 0 ? Vec3d(1, 0, 0) : path[k - 1].normal);
    }
}

std::optional<Crossing2> find_crossing(const Skeleton& skeleton, bool smooth, double tolerance, const std::optional<Vec3d>& along)
{
    const std::vector<Piece> pieces = pieces_of(skeleton, smooth, along);
    std::vector<std::size_t> order(pieces.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return pieces[a].low < pieces[b].low; });
    for (std::size_t m = 0; m < order.size(); ++m) {
        const Piece& p = pieces[order[m]];
        for (std::size_t n = m + 1; n < order.size() && pieces[order[n]].low <= p.high + tolerance; ++n) {
            const Piece& q = pieces[order[n]];
            Vec3d at(0.0);
            if (distance(p, q, at) < tolerance && !may_touch(p, q, order[n])) return Crossing2{std::min(p.arc, q.arc), std::max(p.arc, q.arc), at};
        }
    }
    return std::nullopt;
}

}  // namespace hoodoo
