// Where the ground is torn: bands of one width along the borders of a Voronoi diagram, and the paper's formula for how deep.
#pragma once

#include "terrain/fields/voronoi.h"
#include "terrain/math/interval.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hoodoo
{

enum class SiteKind : std::uint8_t {
    random,  ///< independent and uniform, as in the paper
    even,    ///< each the best of 16 draws, farthest from those before it: cells of like size
};

/// Sites are drawn this far beyond the ground too, in units of their mean spacing: the least that keeps cracks as dense at its rim as elsewhere.
constexpr double kCrackRim = 0.25;

/// `n` sites in the area, then those of the rim around it, as many to a square metre: functions of the seed alone. With SiteKind::random a larger n
/// keeps the first sites of a smaller one.
std::vector<Vec2d> crack_sites(std::uint64_t seed, int n, const Box2d& area, SiteKind kind);
/// The area with its rim.
Box2d crack_box(int n, const Box2d& area);

/// The crack map (aleph) of a diagram. Immutable, thread-safe.
class CrackNetwork
{
public:
    /// `width` across a crack, > 0, in the sites' unit.
    CrackNetwork(VoronoiDiagram diagram, double width);

    const VoronoiDiagram& diagram() const { return diagram_; }
    double width() const { return width_; }

    /// To the nearest middle line of a crack. 1-Lipschitz.
    double distance(const Vec2d& p) const { return diagram_.border_distance(p); }
    bool cracked(const Vec2d& p) const { return distance(p) <= 0.5 * width_; }
    /// Enclosure of distance() over a box.
    Interval distance_range(const Box2d& box) const;
    /// The unit vector from `p` towards the nearest middle line; (1, 0) with a single site.
    Vec2d towards(const Vec2d& p) const;

    /// A stretch of a straight path on one side of the question. At `from` it begins with a wall unless the path or a cell begins there.
    struct Piece {
        double from, to;
        bool cracked;
        bool wall;        ///< the answer changes at `from`
        Vec2d into{0.0};  ///< of that wall: the unit normal that points into the crack
    };
    /// Calls visit(piece) for the pieces of origin + t direction, t in [from, to], in order and without gaps, until it returns false. `direction` may
    /// have any length, 0 too. Where the answer changes depends on the line alone, not on `from` and `to`, to the last bit.
    template <class Visit>
    void for_each_piece(const Vec2d& origin, const Vec2d& direction, double from, double to, Visit&& visit) const;

private:
    /// The convex part of one cell without its cracks, along a path: (enter, leave), empty if enter >= leave; and where the cell ends.
    struct Crossing {
        double enter = -kInfinity, leave = kInfinity, end = kInfinity;
        Vec2d enter_normal{0.0}, leave_normal{0.0};
        std::uint32_t next = 0;
    };
    Crossing cross(std::uint32_t site, const Vec2d& origin, const Vec2d& direction) const;

    VoronoiDiagram diagram_;
    double width_;
};

/// The paper's depth: how the heights of the ground and of a crack's floor belong together. Heights are normalised: 0 the lowest, 1 the highest.
struct CrackDepth {
    double kappa = 0.3;    ///< depth, share of the height, in [0, 1)
    double psi = 0.4;      ///< border line: up to this height cracks are as deep as they get
    double epsilon = 0.2;  ///< border error: over this much above it they vanish; 0: at once

    /// 1 up to psi, 0 from psi + epsilon on, linear between (equations 2 and 3).
    double iota(double h) const;
    /// h' where aleph = 1 (equation 1). Below 0 nothing cracks. Increases with h; jumps at psi if epsilon = 0.
    double floor(double h) const;
    /// The inverse of floor(), continued over its jump: continuous, increasing, at least its argument; a point at height z lies under the floor of a
    /// crack in ground of height h if and only if ground(z) < h, or = h.
    double ground(double z) const;
    /// The derivative of ground(), from above where it has a kink.
    double ground_slope(double z) const;
    /// A proved bound of ground_slope(), all z.
    double most_ground_slope() const { return 1.0 / (1.0 - kappa); }
    /// Where ground_slope() jumps, in order: between them ground() is smooth.
    std::array<double, 3> kinks() const { return {0.0, (1.0 - kappa) * psi, psi + epsilon}; }
    /// A proved bound of |ground_slope(y) - ground_slope(z)| / |y - z| over lo to hi, between which no kink lies (at the ends it may).
    double ground_bend(const Interval& z) const;
};

template <class Visit>
void CrackNetwork::for_each_piece(const Vec2d& origin, const Vec2d& direction, double from, double to, Visit&& visit) const
{
    std::uint32_t site = diagram_.nearest(origin + direction * from);
    double at = from;
    while (at <= to) {
        const Crossing c = cross(site, origin, direction);
        const double end = std::min(to, std::max(at, c.end));
        // Crack, clear ground, crack again: each may be missing.
        const double enter = c.enter < c.leave ? std::clamp(c.enter, at, end) : end;
        const double leave = c.enter < c.leave ? std::clamp(c.leave, enter, end) : end;
        if (at < enter && !visit(Piece{at, enter, true, false, {}})) return;
        if (enter < leave && !visit(Piece{enter, leave, false, enter == c.enter && enter > from, c.enter_normal})) return;
        if (leave < end && !visit(Piece{leave, end, true, leave == c.leave && leave > from, c.leave_normal})) return;
        if (!(c.end < to)) return;
        // Each next site lies farther along the direction, so this ends.
        at = end;
        site = c.next;
    }
}

}  // namespace hoodoo
