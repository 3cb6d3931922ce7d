// A prism is a closed skin of triangles; an axis is inside where it has gone in through more of them than out.
//
// Peytavie2009, section 4.2, carves f~ = min(f, -f*), f* the union of implicit prisms along the skeleton. As printed that makes all bedrock outside
// the tool the zero set, since f* >= 0: it needs the shifted field F* = clamp(-d / sigma, -1, 1), d the signed distance to the profile in the frame
// of the nearest place of the skeleton. f~ = min(f, -F*) differs in sign from f exactly where F* >= 0 > -f, so along an axis only the zeros of F*
// count, the skin of the prisms, and they are found here in closed form: an axis meets a triangle at one height.
//
// Between rings the skin is ruled; each of its quadrilaterals is cut into two triangles, a difference of second order in the step. Winding numbers
// make non-convex sections and prisms that turn inside out on the inner side of a bend right: inside is where the number is not 0, prism by prism.
//
// An edge decides the side of an axis with the same bits for both its triangles, and an axis exactly on an edge counts as moved infinitely little
// towards +x, then towards +y: so the skin has no holes and no double points. Missing: nothing known.
#include "terrain/edit/swept.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// Whether p lies left of the edge from a to b; antisymmetric in a and b, never undecided unless they coincide.
bool left_of(const Vec3d& a, const Vec3d& b, const Vec2d& p)
{
    const bool swapped = b.x < a.x || (b.x == a.x && b.y < a.y);
    const Vec3d &from = swapped ? b : a, &to = swapped ? a : b;
    const double dx = to.x - from.x, dy = to.y - from.y, cross = dx * (p.y - from.y) - dy * (p.x - from.x);
    const bool left = cross != 0.0 ? cross > 0.0 : dy != 0.0 ? dy < 0.0 : dx > 0.0;
    return left != swapped;
}

struct Passing {
    double z;
    int turn;  ///< +1: goes in
};

struct Piece {
    std::uint32_t column;
    double low, high;
};

/// Works in the stack's frame: x and y in cells, z in units.
class Cutter
{
public:
    Cutter(Vec2i size, std::int32_t most) : size_(size), most_(most) {}

    void cut(std::span<const Vec3d> a, std::span<const Vec3d> b)
    {
        if (!begin(a, b)) return;
        const std::size_t n = a.size();
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t m = (k + 1) % n;
            pass(a[k], a[m], b[m]);
            pass(a[k], b[m], b[k]);
            // The ends, as fans: seen from outside they turn the other way round than the sides meet them.
            if (k > 0 && m > 0) pass(a[0], a[m], a[k]), pass(b[0], b[k], b[m]);
        }
        finish();
    }

    std::vector<AxisRuns> result()
    {
        std::sort(pieces_.begin(), pieces_.end(),
                  [](const Piece& p, const Piece& q) { return p.column != q.column ? p.column < q.column : p.low < q.low; });
        std::vector<AxisRuns> all;
        for (std::size_t k = 0; k < pieces_.size();) {
            AxisRuns axis{pieces_[k].column, {}};
            while (k < pieces_.size() && pieces_[k].column == axis.column) {
                Piece whole = pieces_[k++];
                // Prisms that share an end share its heights up to rounding.
                while (k < pieces_.size() && pieces_[k].column == axis.column && pieces_[k].low <= whole.high + 1e-6) {
                    whole.high = std::max(whole.high, pieces_[k++].high);
                }
                const auto units = [&](double z) { return static_cast<std::int32_t>(std::lround(std::clamp(z, 0.0, static_cast<double>(most_)))); };
                axis.runs.push_back({units(whole.low), units(whole.high)});
            }
            unite(axis.runs);
            if (!axis.runs.empty()) all.push_back(std::move(axis));
        }
        return all;
    }

private:
    bool begin(std::span<const Vec3d> a, std::span<const Vec3d> b)
    {
        Box3d box;
        for (const Vec3d& p : a) box.extendBy(p);
        for (const Vec3d& p : b) box.extendBy(p);
        const auto first = [](double x, int n) { return static_cast<int>(std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(n))); };
        const auto last = [](double x, int n) { return static_cast<int>(std::clamp(std::floor(x - 0.5) + 1.0, 0.0, static_cast<double>(n))); };
        from_ = Vec2i(first(box.min.x, size_.x), first(box.min.y, size_.y)), to_ = Vec2i(last(box.max.x, size_.x), last(box.max.y, size_.y));
        if (from_.x >= to_.x || from_.y >= to_.y || box.max.z <= 0.0 || box.min.z >= most_) return false;
        const std::size_t count = static_cast<std::size_t>(to_.x - from_.x) * static_cast<std::size_t>(to_.y - from_.y);
        if (passings_.size() < count) passings_.resize(count);
        for (std::size_t k = 0; k < count; ++k) passings_[k].clear();
        return true;
    }

    std::vector<Passing>& at(int i, int j)
    {
        return passings_[static_cast<std::size_t>(j - from_.y) * static_cast<std::size_t>(to_.x - from_.x) + static_cast<std::size_t>(i - from_.x)];
    }

    void pass(const Vec3d& a, const Vec3d& b, const Vec3d& c)
    {
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (area == 0.0) return;
        const auto least = [](double x, double y, double z) { return std::min(x, std::min(y, z)); };
        const auto most = [](double x, double y, double z) { return std::max(x, std::max(y, z)); };
        const int i0 = std::max(from_.x, static_cast<int>(std::ceil(least(a.x, b.x, c.x) - 0.5)));
        const int i1 = std::min(to_.x, static_cast<int>(std::floor(most(a.x, b.x, c.x) - 0.5)) + 1);
        const int j0 = std::max(from_.y, static_cast<int>(std::ceil(least(a.y, b.y, c.y) - 0.5)));
        const int j1 = std::min(to_.y, static_cast<int>(std::floor(most(a.y, b.y, c.y) - 0.5)) + 1);
        for (int j = j0; j < j1; ++j) {
            for (int i = i0; i < i1; ++i) {
                const Vec2d p(i + 0.5, j + 0.5);
                const bool ab = left_of(a, b, p), bc = left_of(b, c, p), ca = left_of(c, a, p);
                if (ab != bc || bc != ca) continue;
                const double v = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / area;
                const double w = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / area;
                at(i, j).push_back({a.z + v * (b.z - a.z) + w * (c.z - a.z), ab ? 1 : -1});
            }
        }
    }

    void finish()
    {
        for (int j = from_.y; j < to_.y; ++j) {
            for (int i = from_.x; i < to_.x; ++i) {
                std::vector<Passing>& axis = at(i, j);
                if (axis.empty()) continue;
                std::sort(axis.begin(), axis.end(), [](const Passing& a, const Passing& b) { return a.z < b.z; });
                const auto column = static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(size_.x) + static_cast<std::uint32_t>(i);
                int winding = 0;
                for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
                    winding += axis[k].turn;
                    if (winding != 0 && axis[k].z < axis[k + 1].z) pieces_.push_back({column, axis[k].z, axis[k + 1].z});
                }
            }
        }
    }

    Vec2i size_, from_{0, 0}, to_{0, 0};
    std::int32_t most_;
    std::vector<std::vector<Passing>> passings_;
    std::vector<Piece> pieces_;
};

}  // namespace

std::vector<AxisRuns> swept_runs(const MaterialStack& stack, std::span<const std::vector<Ring>> tubes, std::int32_t most)
{
    Cutter cutter(stack.size(), most);
    const auto in_frame = [&](const Ring& ring) {
        std::vector<Vec3d> corners;
        for (const Vec3d& p : ring.corners) {
            const Vec3d q = p - stack.origin();
            corners.emplace_back(q.x / stack.cell(), q.y / stack.cell(), q.z / stack.unit());
        }
        return corners;
    };
    for (const std::vector<Ring>& tube : tubes) {
        std::vector<Vec3d> last;
        for (const Ring& ring : tube) {
            std::vector<Vec3d> next = in_frame(ring);
            if (!last.empty()) cutter.cut(last, next);
            last = std::move(next);
        }
    }
    return cutter.result();
}

}  // namespace hoodoo
