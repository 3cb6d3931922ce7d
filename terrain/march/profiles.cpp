// The field of a layer stack along lattice lines, and the pieces of lattice cells in which it changes sign (Peytavie2009, section 3.3).
//
// At a lattice vertex V is the sum over K x K columns of D(Z) = C(Z) - C(Z - height), C the matter of a column below Z. A run of matter
// [bottom, top] bends D at bottom (+1), top (-1), bottom + height (-1) and top + height (+1): sorted and summed, these are the knots.
// Between merged knots of its four corners F is trilinear in a cell, so the signs of eight numbers decide whether a slab holds surface.

#include "terrain/march/profiles.h"

#include <algorithm>

namespace hoodoo
{
namespace
{

void tight_axis(const std::array<double, 4>& from, const std::array<double, 4>& to, double& lo, double& hi)
{
    const auto negative = [](const std::array<double, 4>& v) {
        return static_cast<int>(std::count_if(v.begin(), v.end(), [](double x) { return x < 0.0; }));
    };
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

/// Reads a profile upwards, from the last knot at or below `start`.
class Cursor
{
public:
    Cursor(const Profile& profile, double start) : knots_(profile.knots)
    {
        const auto above = std::upper_bound(knots_.begin(), knots_.end(), start, [](double z, const Knot& k) { return z < k.z; });
        at_ = static_cast<std::size_t>(above - knots_.begin());
    }
    double next() const { return at_ < knots_.size() ? knots_[at_].z : kInfinity; }
    double value(double z)
    {
        while (at_ < knots_.size() && knots_[at_].z <= z) ++at_;
        if (at_ == 0) return knots_.front().value;
        const Knot& k = knots_[at_ - 1];
        return k.value + k.slope * (z - k.z);
    }

private:
    const std::vector<Knot>& knots_;
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
class ChainMaker
{
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

ProfileRows::Bends ProfileRows::column(int i, int j) const
{
    Bends bends;
    ground_.for_each_run(i, j, [&](Run run) {
        if (run.bottom == Ground::bottomless) {
            bends.overlap += lattice_.height;
        } else {
            bends.list.push_back({static_cast<double>(run.bottom), 1.0});
            bends.list.push_back({run.bottom + lattice_.height, -1.0});
        }
        bends.list.push_back({static_cast<double>(run.top), -1.0});
        bends.list.push_back({run.top + lattice_.height, 1.0});
    });
    std::sort(bends.list.begin(), bends.list.end(), [](const Bend& p, const Bend& q) { return p.z < q.z; });
    return bends;
}

void ProfileRows::merge(const Bends& more, Bends& into, std::vector<Bend>& scratch)
{
    scratch.resize(into.list.size() + more.list.size());
    std::merge(into.list.begin(), into.list.end(), more.list.begin(), more.list.end(), scratch.begin(),
               [](const Bend& p, const Bend& q) { return p.z < q.z; });
    into.list.swap(scratch);
    into.overlap += more.overlap;
}

Profile ProfileRows::integrate(const Bends& bends) const
{
    // F = factor (K^2 height / 2 - overlap): negative where more than half of the kernel is matter.
    const double middle = static_cast<double>(lattice_.kernel) * lattice_.kernel * lattice_.height / 2.0;
    double overlap = bends.overlap;
    Profile profile;
    profile.knots.reserve(bends.list.size() + 1);
    double slope = 0.0, z = bends.list.empty() ? 0.0 : bends.list.front().z;
    if (bends.list.empty()) profile.knots.push_back({0.0, lattice_.factor * (middle - overlap), 0.0});
    for (std::size_t k = 0; k < bends.list.size();) {
        overlap += slope * (bends.list[k].z - z);
        z = bends.list[k].z;
        for (; k < bends.list.size() && bends.list[k].z == z; ++k) slope += bends.list[k].slope;
        const double value = lattice_.factor * (middle - overlap);
        if (!profile.knots.empty() && (profile.knots.back().value < lattice_.delta) != (value < lattice_.delta)) {
            profile.first = std::min(profile.first, profile.knots.back().z);
            profile.last = z;
        }
        profile.knots.push_back({z, value, -lattice_.factor * slope});
    }
    return profile;
}

std::vector<Profile> ProfileRows::row(int b)
{
    // Keep the rows of columns under the kernel of this row of vertices.
    const int j0 = lattice_.first_column(b), i0 = lattice_.first_column(a0_), count = a1_ - a0_ + lattice_.kernel;
    if (columns_.empty() || j0 < first_row_ || j0 > first_row_ + static_cast<int>(columns_.size())) columns_.clear(), first_row_ = j0;
    while (first_row_ < j0 && !columns_.empty()) columns_.erase(columns_.begin()), ++first_row_;
    while (static_cast<int>(columns_.size()) < lattice_.kernel) {
        std::vector<Bends>& next = columns_.emplace_back();
        const int j = first_row_ + static_cast<int>(columns_.size()) - 1;
        for (int k = 0; k < count; ++k) next.push_back(column(i0 + k, j));
    }

    // Merge first along y, then along x: neighbouring vertices share the former.
    std::vector<Bend> scratch;
    std::vector<Bends> strips(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < strips.size(); ++k)
        for (const std::vector<Bends>& line : columns_) merge(line[k], strips[k], scratch);
    std::vector<Profile> profiles;
    profiles.reserve(static_cast<std::size_t>(a1_ - a0_ + 1));
    Bends all;
    for (int a = a0_; a <= a1_; ++a) {
        all.list.clear();
        all.overlap = 0.0;
        for (int k = 0; k < lattice_.kernel; ++k) merge(strips[static_cast<std::size_t>(a - a0_ + k)], all, scratch);
        profiles.push_back(integrate(all));
    }
    return profiles;
}

void cell_chains(const Lattice& lattice, int a, int b, const std::array<const Profile*, 4>& corners, const ChainLimits& limits,
                 std::vector<Chain>& out)
{
    // Far below all corners have one sign, and far above: between, it is enough to look where one of them changes it.
    double first = kInfinity, last = -kInfinity;
    for (const Profile* p : corners) first = std::min(first, p->first), last = std::max(last, p->last);
    if (!(first < last)) return;
    std::array<Cursor, 4> cursor{Cursor(*corners[0], first), Cursor(*corners[1], first), Cursor(*corners[2], first), Cursor(*corners[3], first)};
    ChainMaker maker(lattice, a, b, limits, out);
    Level lower{first, {}};
    int below = 0;
    for (int i = 0; i < 4; ++i) lower.value[i] = cursor[i].value(first), below += lower.value[i] < lattice.delta;
    while (lower.z < last) {
        double z = kInfinity;
        for (const Cursor& c : cursor) z = std::min(z, c.next());
        Level level{z, {}};
        int inside = 0;
        for (int i = 0; i < 4; ++i) level.value[i] = cursor[i].value(z), inside += level.value[i] < lattice.delta;
        if (inside + below != 0 && inside + below != 8) maker.add_slab(lower, level);
        lower = level;
        below = inside;
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
