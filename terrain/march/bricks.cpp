// Proved bricks from the profiles of the field along vertical lines.
//
// Along the vertical through a crossing of two lines the field is piecewise linear in Z; inside a cell between lines it is bilinear in (X, Y) at
// each Z, a mean of its four corner profiles (maths of stacks, A2). Hence, exactly and without sampling:
//   where all four profiles are on one side, the cell has no surface;
//   the X component of the gradient lies between the differences of profiles along X, which are piecewise linear too, so their extremes are
//   at knots; likewise Y; the Z component lies between the profiles' slopes.
// The remaining Z ranges of the cells of a block are cut into bricks of about a cube.

#include "terrain/march/bricks.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

/// f - delta along a vertical line: linear between knots, constant outside.
struct Profile {
    std::vector<double> z, f;

    double at(double height) const
    {
        const auto next = std::upper_bound(z.begin(), z.end(), height);
        if (next == z.begin()) return f.front();
        if (next == z.end()) return f.back();
        const auto k = static_cast<std::size_t>(next - z.begin());
        return f[k - 1] + (f[k] - f[k - 1]) * ((height - z[k - 1]) / (z[k] - z[k - 1]));
    }
};

struct Bend {
    double z, slope;
};

Profile make_profile(const Ground& ground, const KernelFrame& frame, double x, double y, std::vector<Bend>& bends)
{
    bends.clear();
    double volume = 0.0;
    for (int j = frame.first_column(y); j <= frame.last_column(y); ++j) {
        const double wy = frame.overlap(y, j);
        if (wy == 0.0) continue;
        for (int i = frame.first_column(x); i <= frame.last_column(x); ++i) {
            const double w = wy * frame.overlap(x, i);
            if (w == 0.0) continue;
            ground.for_each_run(i, j, [&](const Run& run) {
                if (run.bottom == Ground::bottomless) {
                    volume += w * 2.0 * frame.height;
                } else {
                    bends.push_back({run.bottom - frame.height, w});
                    bends.push_back({run.bottom + frame.height, -w});
                }
                bends.push_back({run.top - frame.height, -w});
                bends.push_back({run.top + frame.height, w});
            });
        }
    }
    std::sort(bends.begin(), bends.end(), [](const Bend& a, const Bend& b) { return a.z < b.z; });
    Profile p;
    double slope = 0.0;
    for (std::size_t k = 0; k < bends.size();) {
        const double z = bends[k].z;
        if (!p.z.empty()) volume += slope * (z - p.z.back());
        p.z.push_back(z);
        p.f.push_back(1.0 - frame.scale * volume - KernelFrame::delta);
        for (; k < bends.size() && bends[k].z == z; ++k) slope += bends[k].slope;
    }
    if (p.z.empty()) p.z.push_back(0.0), p.f.push_back(1.0 - frame.scale * volume - KernelFrame::delta);
    return p;
}

using Corners = std::array<const Profile*, 4>;  ///< x fast

/// Heights at which one profile passes +- rounding: between neighbours in the list each profile keeps its state.
void add_passages(const Profile& p, std::vector<double>& heights)
{
    for (std::size_t k = 1; k < p.z.size(); ++k) {
        for (const double level : {-KernelFrame::rounding, KernelFrame::rounding}) {
            const double a = p.f[k - 1] - level, b = p.f[k] - level;
            if ((a < 0.0) != (b < 0.0)) heights.push_back(p.z[k - 1] + (p.z[k] - p.z[k - 1]) * (a / (a - b)));
        }
    }
}

struct Range {
    double lo, hi;
};

/// Z ranges in which the four profiles are not all clearly on one side, a hair widened.
void undecided(const Corners& corners, std::vector<double>& heights, std::vector<Range>& ranges)
{
    heights.clear();
    ranges.clear();
    for (const Profile* p : corners) add_passages(*p, heights);
    if (heights.empty()) return;
    std::sort(heights.begin(), heights.end());
    const auto decided = [&](double z) {
        int above = 0, below = 0;
        for (const Profile* p : corners) {
            const double f = p->at(z);
            above += f > KernelFrame::rounding;
            below += f < -KernelFrame::rounding;
        }
        return above == 4 || below == 4;
    };
    const double hair = 1e-9 * (1.0 + std::max(std::abs(heights.front()), std::abs(heights.back())));
    const auto append = [&](double lo, double hi) {
        if (!ranges.empty() && lo - hair <= ranges.back().hi)
            ranges.back().hi = hi + hair;
        else
            ranges.push_back({lo - hair, hi + hair});
    };
    append(heights.front(), heights.front());
    for (std::size_t k = 1; k < heights.size(); ++k) {
        if (heights[k] - heights[k - 1] <= 2.0 * hair || !decided(0.5 * (heights[k - 1] + heights[k])))
            append(heights[k - 1], heights[k]);
        else
            append(heights[k], heights[k]);
    }
}

struct Slopes {
    Vec3d lo{kInfinity}, hi{-kInfinity};
    void extend(int axis, double v) { lo[axis] = std::min(lo[axis], v), hi[axis] = std::max(hi[axis], v); }
};

/// Reads a profile upwards from a height.
class Cursor
{
public:
    Cursor(const Profile& p, double z) : p_(p), k_(static_cast<std::size_t>(std::upper_bound(p.z.begin(), p.z.end(), z) - p.z.begin())) {}
    double next() const { return k_ < p_.z.size() ? p_.z[k_] : kInfinity; }
    void pass() { ++k_; }
    double slope() const { return k_ == 0 || k_ == p_.z.size() ? 0.0 : (p_.f[k_] - p_.f[k_ - 1]) / (p_.z[k_] - p_.z[k_ - 1]); }
    double at(double z) const
    {
        if (k_ == 0) return p_.f.front();
        if (k_ == p_.z.size()) return p_.f.back();
        return p_.f[k_ - 1] + (p_.f[k_] - p_.f[k_ - 1]) * ((z - p_.z[k_ - 1]) / (p_.z[k_] - p_.z[k_ - 1]));
    }

private:
    const Profile& p_;
    std::size_t k_;
};

/// Extends by (b - a) / h over the heights of `range`: extremes are at its ends and at knots.
void extend_across(const Profile& a, const Profile& b, const Range& range, int axis, double h, Slopes& slopes)
{
    Cursor ca(a, range.lo), cb(b, range.lo);
    double z = range.lo;
    for (;;) {
        slopes.extend(axis, (cb.at(z) - ca.at(z)) / h);
        if (z >= range.hi) return;
        z = std::min({ca.next(), cb.next(), range.hi});
        if (ca.next() == z) ca.pass();
        if (cb.next() == z) cb.pass();
    }
}

/// Extends by the profile's own slopes over the heights of `range`.
void extend_along(const Profile& p, const Range& range, Slopes& slopes)
{
    Cursor c(p, range.lo);
    slopes.extend(2, c.slope());
    while (c.next() < range.hi) {
        c.pass();
        slopes.extend(2, c.slope());
    }
}

struct CellRange {
    std::uint16_t x, y;
    Range range;
};

float outwards(double v, double scale)
{
    // One part in a million: above the rounding to single precision and that of the differences.
    return static_cast<float>(v + 1e-6 * (std::abs(v) + std::abs(scale)) * (scale < 0.0 ? -1.0 : 1.0));
}

class TileBuilder
{
public:
    TileBuilder(const Ground& ground, const KernelFrame& frame, const TileLines& lines) : frame_(frame), lines_(lines)
    {
        profiles_.reserve(lines.x.size() * lines.y.size());
        std::vector<Bend> bends;
        for (const double y : lines.y)
            for (const double x : lines.x) profiles_.push_back(make_profile(ground, frame, x, y, bends));
    }

    std::vector<Brick> build(int edge)
    {
        const double height = edge * frame_.cell / frame_.unit;
        for (std::size_t y = 0, ye = 0; y + 1 < lines_.y.size(); y = ye) {
            ye = block_end(lines_.y, y, edge);
            for (std::size_t x = 0, xe = 0; x + 1 < lines_.x.size(); x = xe) {
                xe = block_end(lines_.x, x, edge);
                build_block(x, xe, y, ye, height);
            }
        }
        bricks_.shrink_to_fit();
        return std::move(bricks_);
    }

private:
    static std::size_t block_end(const std::vector<double>& lines, std::size_t first, int edge)
    {
        std::size_t end = first + 1;
        while (end + 1 < lines.size() && lines[end] < lines[first] + edge - 0.25) ++end;
        return end;
    }

    Corners corners(std::size_t x, std::size_t y) const
    {
        const Profile* p = &profiles_[y * lines_.x.size() + x];
        return {p, p + 1, p + lines_.x.size(), p + lines_.x.size() + 1};
    }

    void build_block(std::size_t xa, std::size_t xb, std::size_t ya, std::size_t yb, double height)
    {
        cells_.clear();
        for (std::size_t y = ya; y < yb; ++y) {
            for (std::size_t x = xa; x < xb; ++x) {
                undecided(corners(x, y), heights_, ranges_);
                for (const Range& r : ranges_) cells_.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), r});
            }
        }
        std::sort(cells_.begin(), cells_.end(), [](const CellRange& a, const CellRange& b) { return a.range.lo < b.range.lo; });

        // Ranges that overlap stay together, then are cut into equal parts of at most the height of a cube.
        for (std::size_t first = 0; first < cells_.size();) {
            double top = cells_[first].range.hi;
            std::size_t last = first + 1;
            while (last < cells_.size() && cells_[last].range.lo <= top) top = std::max(top, cells_[last++].range.hi);
            const double bottom = cells_[first].range.lo;
            const int parts = std::max(1, static_cast<int>(std::ceil((top - bottom) / height)));
            for (int k = 0; k < parts; ++k) {
                const double lo = k == 0 ? bottom : bottom + (top - bottom) * k / parts;
                const double hi = k + 1 == parts ? top : bottom + (top - bottom) * (k + 1) / parts;
                add_brick(first, last, {lo, hi});
            }
            first = last;
        }
    }

    void add_brick(std::size_t first, std::size_t last, const Range& part)
    {
        Brick b{kInfinity, -kInfinity, 0xffff, 0, 0xffff, 0, {}, {}};
        Slopes slopes;
        for (std::size_t k = first; k < last; ++k) {
            const CellRange& c = cells_[k];
            const Range r{std::max(c.range.lo, part.lo), std::min(c.range.hi, part.hi)};
            if (r.lo > r.hi) continue;
            b.z0 = std::min(b.z0, r.lo), b.z1 = std::max(b.z1, r.hi);
            b.x0 = std::min(b.x0, c.x), b.x1 = std::max<std::uint16_t>(b.x1, c.x + 1u);
            b.y0 = std::min(b.y0, c.y), b.y1 = std::max<std::uint16_t>(b.y1, c.y + 1u);
        }
        if (b.z0 > b.z1) return;
        // The bounds are for the whole box, cells without surface included: a ray crosses them too.
        const Range height{b.z0, b.z1};
        for (std::size_t y = b.y0; y <= b.y1; ++y) {
            for (std::size_t x = b.x0; x <= b.x1; ++x) {
                const Profile* p = &profiles_[y * lines_.x.size() + x];
                extend_along(*p, height, slopes);
                if (x < b.x1) extend_across(p[0], p[1], height, 0, lines_.x[x + 1] - lines_.x[x], slopes);
                if (y < b.y1) extend_across(p[0], p[lines_.x.size()], height, 1, lines_.y[y + 1] - lines_.y[y], slopes);
            }
        }
        for (int k = 0; k < 3; ++k) {
            const double size = std::max(std::abs(slopes.lo[k]), std::abs(slopes.hi[k]));
            b.slope_lo[static_cast<std::size_t>(k)] = outwards(slopes.lo[k], -size);
            b.slope_hi[static_cast<std::size_t>(k)] = outwards(slopes.hi[k], size);
        }
        bricks_.push_back(b);
    }

    const KernelFrame& frame_;
    const TileLines& lines_;
    std::vector<Profile> profiles_;
    std::vector<double> heights_;
    std::vector<Range> ranges_;
    std::vector<CellRange> cells_;
    std::vector<Brick> bricks_;
};

std::vector<double> axis_lines(const KernelFrame& frame, double lo, double hi)
{
    std::vector<double> lines{lo, hi};
    const int last = static_cast<int>(std::ceil(hi + frame.reach));
    for (int i = static_cast<int>(std::floor(lo - frame.reach)); i <= last; ++i) {
        for (const double x : {i - frame.reach, i + frame.reach})
            if (x > lo && x < hi) lines.push_back(x);
    }
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    return lines;
}

}  // namespace

TileLines tile_lines(const KernelFrame& frame, const Vec2d& lo, const Vec2d& hi)
{
    return {axis_lines(frame, lo.x, hi.x), axis_lines(frame, lo.y, hi.y)};
}

std::vector<Brick> make_bricks(const Ground& ground, const KernelFrame& frame, const TileLines& lines, int edge)
{
    return TileBuilder(ground, frame, lines).build(edge);
}

}  // namespace hoodoo
