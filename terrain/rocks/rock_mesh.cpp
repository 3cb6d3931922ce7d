// A star-shaped polygonisation: one root of Phi on each ray from a rock's middle.
//
// Rays start where they leave the cell (there Phi >= 0) and come inwards: steps of Phi / slope cannot pass a crossing (Hart1996); once Phi is under
// 0.02 r, Newton's steps inside the bracket end it. So the crossing found is the outermost one, but for notches thinner than 0.02 r. A net of
// directions whose triangles all turn the same way around the middle gives a mesh that is closed and cannot intersect itself, whatever the
// lengths are; its vertices lie in the convex cell, so its triangles do, and two rocks cannot overlap at any level of detail.
// The direction nearest to each contact is moved onto it, and the net around it relaxed: the meshes of two rocks share the very point. A move that
// would fold the net is taken back. Missing: what a middle does not see (a rock is a convex body worn by a fraction of its radius: little).

#include "terrain/rocks/rock_mesh.h"

#include "terrain/error.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace hoodoo
{
namespace
{

constexpr std::array<int, kRockLevels> kFrequency = {20, 12, 6, 3};

/// The net with its contacts: `fixed` directions stay.
class Net
{
public:
    Net(const DirectionBall& ball, const Vec3d& stretch) : ball_(ball), direction_(ball.directions), fixed_(ball.directions.size(), -1)
    {
        for (Vec3d& d : direction_) d = (d * stretch).normalized();
        triangles_of_.resize(direction_.size());
        for (std::size_t t = 0; t < ball.triangles.size(); ++t)
            for (const std::uint32_t v : ball.triangles[t]) triangles_of_[v].push_back(t);
    }

    /// Moves the nearest free direction onto `d`, if that folds nothing.
    void pin(const Vec3d& d, int contact)
    {
        std::size_t best = direction_.size();
        for (std::size_t k = 0; k < direction_.size(); ++k)
            if (fixed_[k] < 0 && (best == direction_.size() || direction_[k].dot(d) > direction_[best].dot(d))) best = k;
        if (best == direction_.size() || !move(best, d)) return;
        fixed_[best] = contact;
        // Two rings give way, so that triangles stay well-shaped.
        std::vector<std::uint32_t> around(ball_.neighbours[best]);
        for (const std::uint32_t k : ball_.neighbours[best]) around.insert(around.end(), ball_.neighbours[k].begin(), ball_.neighbours[k].end());
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (int round = 0; round < 2; ++round)
            for (const std::uint32_t k : around)
                if (fixed_[k] < 0) relax(k);
    }

    const std::vector<Vec3d>& directions() const { return direction_; }
    int contact(std::size_t k) const { return fixed_[k]; }

private:
    bool move(std::size_t k, const Vec3d& to)
    {
        const Vec3d before = direction_[k];
        direction_[k] = to;
        for (const std::size_t t : triangles_of_[k]) {
            const auto& [a, b, c] = ball_.triangles[t];
            // A fifth of the area of an equilateral triangle with these sides' mean: not folded, not a needle.
            const Vec3d ab = direction_[b] - direction_[a], ac = direction_[c] - direction_[a], bc = direction_[c] - direction_[b];
            const double turned = ab.cross(ac).dot(direction_[a]), sides = ab.length2() + ac.length2() + bc.length2();
            if (turned > 0.05 * sides) continue;
            direction_[k] = before;
            return false;
        }
        return true;
    }
    void relax(std::size_t k)
    {
        Vec3d sum(0.0);
        for (const std::uint32_t other : ball_.neighbours[k]) sum += direction_[other];
        move(k, (direction_[k] + sum.normalized()).normalized());
    }

    const DirectionBall& ball_;
    std::vector<Vec3d> direction_;
    std::vector<int> fixed_;
    std::vector<std::vector<std::size_t>> triangles_of_;
};

/// The outermost root of Phi on centre + t d, and the gradient there.
double outermost_root(const RockField& field, const Vec3d& centre, const Vec3d& d, Vec3d& gradient)
{
    const double r = field.radius();
    double outside = field.exit(centre, d), inside = 0.0;
    double t = outside;
    for (int step = 0; step < 200; ++step) {
        const RockField::Sample s = field.sample(centre + d * t);
        gradient = s.gradient;
        if (std::abs(s.value) <= 1e-8 * r) break;
        if (s.value > 0.0)
            outside = t;
        else
            inside = t;
        if (s.value > 0.02 * r && inside == 0.0) {
            t = std::max(0.5 * t, t - s.value / field.slope());
            continue;
        }
        const double newton = t - s.value / s.gradient.dot(d);
        t = newton > inside && newton < outside ? newton : 0.5 * (inside + outside);
        if (outside - inside <= 1e-12 * r) break;
    }
    return t;
}

}  // namespace

std::size_t rock_triangles(int level)
{
    const auto n = static_cast<std::size_t>(kFrequency[static_cast<std::size_t>(level)]);
    return 20 * n * n;
}

DirectionBall direction_ball(int level)
{
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    const std::array<Vec3d, 12> corner = {Vec3d(-1, g, 0),  Vec3d(1, g, 0),  Vec3d(-1, -g, 0), Vec3d(1, -g, 0), Vec3d(0, -1, g),  Vec3d(0, 1, g),
                                          Vec3d(0, -1, -g), Vec3d(0, 1, -g), Vec3d(g, 0, -1),  Vec3d(g, 0, 1),  Vec3d(-g, 0, -1), Vec3d(-g, 0, 1)};
    constexpr std::array<std::array<int, 3>, 20> faces = {{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                                           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                                           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
    const int n = kFrequency[static_cast<std::size_t>(level)];
    DirectionBall ball;
    // A lattice point is named by its corners and how much of each it has: the same from every face that has it.
    std::map<std::array<int, 6>, std::uint32_t> known;
    for (const auto& face : faces) {
        const auto at = [&](int i, int j) {
            std::array<std::pair<int, int>, 3> parts = {{{face[0], n - i - j}, {face[1], i}, {face[2], j}}};
            for (auto& part : parts)
                if (part.second == 0) part.first = -1;
            std::sort(parts.begin(), parts.end());
            const std::array<int, 6> name = {parts[0].first, parts[0].second, parts[1].first, parts[1].second, parts[2].first, parts[2].second};
            const auto [found, fresh] = known.try_emplace(name, static_cast<std::uint32_t>(ball.directions.size()));
            if (fresh) {
                Vec3d sum(0.0);
                for (const auto& [c, weight] : parts)
                    if (c >= 0) sum += corner[static_cast<std::size_t>(c)] * weight;
                ball.directions.push_back(sum.normalized());
            }
            return found->second;
        };
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n - i; ++j) {
                ball.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                if (j < n - i - 1) ball.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
    }
    ball.neighbours.resize(ball.directions.size());
    for (const auto& t : ball.triangles)
        for (std::size_t k = 0; k < 3; ++k) ball.neighbours[t[k]].push_back(t[(k + 1) % 3]);
    return ball;
}

TriangleMesh rock_mesh(const RockField& field, const Vec3d& centre, const DirectionBall& ball, const Vec3d& stretch)
{
    if (!(field.value(centre) < 0.0)) throw Error(ErrorKind::internal, "a rock is worn away at its middle");
    Net net(ball, stretch);
    for (std::size_t c = 0; c < field.contacts().size(); ++c) net.pin((field.contacts()[c] - centre).normalized(), static_cast<int>(c));

    TriangleMesh mesh;
    mesh.triangles = ball.triangles;
    mesh.vertices.reserve(ball.directions.size());
    mesh.normals.reserve(ball.directions.size());
    for (std::size_t k = 0; k < ball.directions.size(); ++k) {
        const Vec3d d = net.directions()[k];
        Vec3d gradient, p;
        if (net.contact(k) >= 0) {
            p = field.contacts()[static_cast<std::size_t>(net.contact(k))];
            gradient = field.gradient(p);
        } else {
            p = centre + d * outermost_root(field, centre, d, gradient);
        }
        mesh.vertices.emplace_back(p);
        mesh.normals.emplace_back(gradient.length() > 1e-9 ? gradient.normalized() : d);
    }
    return mesh;
}

}  // namespace hoodoo
