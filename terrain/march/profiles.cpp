// The field of a layer stack along lattice lines, and the pieces of lattice cells in which it changes sign (Peytavie2009, section 3.3).
//
// At a lattice vertex V is the sum over K x K columns of D(Z) = C(Z) - C(Z - height), C the matter of a column below Z. A run of matter
// [bottom, top] bends D at bottom (+1), top (-1), bottom + height (-1) and top + height (+1): sorted and summed, these are the knots.
// Between merged knots of its four corners F is trilinear in a cell, so the signs of eight numbers decide whether a slab holds surface.

#include "terrain/march/profiles.h"

#include <algorithm>

namespace hoodoo {
namespace {

struct Bend {
    double z;
    double slope;
};

void tight_axis(const std::array<double, 4>& from, const std::array<double, 4>& to, double& lo, double& hi)
{
    const auto negative = [](const std::array<double, 4>& v) { return static_cast<int>(std::count_if(v.begin(), v.end(), [](double x) { return x < 0.0; })); };
    const int below = negative(from), above = negative(to);
    lo = 0.0, hi = 1.0;
    if (below == 0 || below == 4) {
        lo = 2.0;
        for (int i = 0; i < 4; ++i)
            if ((from[i] < 0.0) != (to[i] < 0.0)) lo = std::min(lo, from[i] / (from[i] - to[i]));
    }
    if (above == 0 || above == 4) {
        hi = -1.0;
        for (int i = 0; i < 4; ++i)
            if ((from[i] < 0.0) != (to[i] < 0.0)) hi = std::max(hi, from[i] / (from[i] - to[i]));
    }
}

/// Reads a profile upwards.
class Cursor {
public:
    explicit Cursor(const Profile& profile) : profile_(profile) {}
    double next() const { return at_ < profile_.size() ? profile_[at_].z : kInfinity; }
    double value(double z)
    {
        while (at_ < profile_.size() && profile_[at_].z <= z) ++at_;
        if (at_ == 0) return profile_.front().value;
        const Knot& k = profile_[at_ - 1];
        return k.value + k.slope * (z - k.z);
    }

private:
    const Profile& profile_;
    std::size_t at_ = 0;
};

Level between(const Level& a, const Level& b, double z)
{
    Level l{z, {}};
    const double w = (z - a.z) / (b.z - a.z);
    // Both ends are integers and so is the slope where the lattice is whole: rounding then restores exactly what was stored.
    for (int i = 0; i < 4; ++i) l.value[i] = a.value[i] + (b.value[i] - a.value[i]) * w;
    return l;
}

/// Collects slabs of one cell into chains.
class ChainMaker {
public:
    ChainMaker(const Lattice& lattice, int a, int b, const ChainLimits& limits, std::vector<Chain>& out)
        : lattice_(lattice), a_(a), b_(b), limits_(limits), out_(out)
    {
    }

    /// A slab between two levels of merged knots: keeps the part that can hold surface, cut to the height limit.
    void add_slab(const Level& lower, const Level& upper)
    {
        double lo, hi;
        std::array<double, 4> from, to;
        for (int i = 0; i < 4; ++i) from[i] = lower.value[i] - lattice_.delta, to[i] = upper.value[i] - lattice_.delta;
        tight_axis(from, to, lo, hi);
        if (lo > hi) return;
        // One ulp of slack, then outwards to whole units, on which the values are exact.
        const double span = upper.z - lower.z, slack = 1e-9 * span;
        double z0 = lower.z + lo * span - slack, z1 = lower.z + hi * span + slack;
        if (lattice_.whole) z0 = std::floor(z0), z1 = std::ceil(z1);
        z0 = std::max(z0, lower.z), z1 = std::min(z1, upper.z);
        if (!(z0 < z1)) return;
        const int pieces = std::max(1, static_cast<int>(std::ceil((z1 - z0) / limits_.height)));
        for (int i = 0; i < pieces; ++i) {
            double p = z0 + (z1 - z0) * i / pieces, q = z0 + (z1 - z0) * (i + 1) / pieces;
            if (lattice_.whole) p = std::floor(p), q = std::floor(q);
            push(exact(lower, upper, p), exact(lower, upper, q));
        }
    }

private:
    Level exact(const Level& a, const Level& b, double z) const
    {
        if (z == a.z) return a;
        if (z == b.z) return b;
        Level l = between(a, b, z);
        if (lattice_.whole)
            for (double& v : l.value) v = std::round(v);
        return l;
    }

    void push(const Level& lower, const Level& upper)
    {
        const bool continues = !out_.empty() && out_.back().a == a_ && out_.back().b == b_ && out_.back().levels.back().z == lower.z &&
                               out_.back().levels.size() < limits_.levels && upper.z - out_.back().levels.front().z <= limits_.height;
        if (!continues) out_.push_back({a_, b_, {lower}});
        out_.back().levels.push_back(upper);
    }

    const Lattice& lattice_;
    int a_, b_;
    const ChainLimits& limits_;
    std::vector<Chain>& out_;
};

}  // namespace

Profile vertex_profile(const Ground& ground, const Lattice& lattice, int a, int b)
{
    // Gather the bends of all columns under the kernel; bottomless runs overlap the whole kernel far below.
    thread_local std::vector<Bend> bends;
    bends.clear();
    double overlap = 0.0;
    const int i0 = lattice.first_column(a), j0 = lattice.first_column(b);
    for (int j = j0; j < j0 + lattice.kernel; ++j) {
        for (int i = i0; i < i0 + lattice.kernel; ++i) {
            ground.for_each_run(i, j, [&](Run run) {
                if (run.bottom == Ground::bottomless) {
                    overlap += lattice.height;
                } else {
                    bends.push_back({static_cast<double>(run.bottom), 1.0});
                    bends.push_back({run.bottom + lattice.height, -1.0});
                }
                bends.push_back({static_cast<double>(run.top), -1.0});
                bends.push_back({run.top + lattice.height, 1.0});
            });
        }
    }
    std::sort(bends.begin(), bends.end(), [](const Bend& p, const Bend& q) { return p.z < q.z; });

    // Integrate upwards. F = factor (K^2 height / 2 - overlap): negative where more than half of the kernel is matter.
    const double middle = static_cast<double>(lattice.kernel) * lattice.kernel * lattice.height / 2.0;
    Profile profile;
    profile.reserve(bends.size() + 1);
    double slope = 0.0, z = bends.empty() ? 0.0 : bends.front().z;
    if (bends.empty()) profile.push_back({0.0, lattice.factor * (middle - overlap), 0.0});
    for (std::size_t k = 0; k < bends.size();) {
        overlap += slope * (bends[k].z - z);
        z = bends[k].z;
        for (; k < bends.size() && bends[k].z == z; ++k) slope += bends[k].slope;
        profile.push_back({z, lattice.factor * (middle - overlap), -lattice.factor * slope});
    }
    return profile;
}

void cell_chains(const Lattice& lattice, int a, int b, const std::array<const Profile*, 4>& corners, const ChainLimits& limits, std::vector<Chain>& out)
{
    std::array<Cursor, 4> cursor{Cursor(*corners[0]), Cursor(*corners[1]), Cursor(*corners[2]), Cursor(*corners[3])};
    ChainMaker maker(lattice, a, b, limits, out);
    Level lower{};
    bool first = true;
    while (true) {
        double z = kInfinity;
        for (const Cursor& c : cursor) z = std::min(z, c.next());
        if (z == kInfinity) break;
        Level level{z, {}};
        int inside = 0;
        for (int i = 0; i < 4; ++i) {
            level.value[i] = cursor[i].value(z);
            inside += level.value[i] < lattice.delta;
        }
        if (!first) {
            int below = 0;
            for (const double v : lower.value) below += v < lattice.delta;
            if (inside + below != 0 && inside + below != 8) maker.add_slab(lower, level);
        }
        lower = level;
        first = false;
    }
}

void tight_box(const std::array<double, 8>& value, Vec3d& lo, Vec3d& hi)
{
    static constexpr std::array<std::array<int, 4>, 3> near{{{0, 2, 4, 6}, {0, 1, 4, 5}, {0, 1, 2, 3}}};
    static constexpr std::array<int, 3> step{1, 2, 4};
    for (int k = 0; k < 3; ++k) {
        std::array<double, 4> from, to;
        for (int i = 0; i < 4; ++i) from[i] = value[near[k][i]], to[i] = value[near[k][i] + step[k]];
        tight_axis(from, to, lo[k], hi[k]);
    }
}

}  // namespace hoodoo
