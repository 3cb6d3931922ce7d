// A ray over a height grid is a broken line of heights above the ground, F(t) = z(t) - h(x(t), y(t)): it bends only where the ray passes a line of
// the grid or a diagonal, so the signs of F at these places, in their order, show every crossing. Amanatides1987 for the walk; GalinCourse for the
// triangles; Tevs2008 for culling by extremes. In grid coordinates the ray passes the line u = i at t_u(i) = (i - u0) / du, likewise t_v(j). Why no
// ray slips through:
//   1. t_u(i) and t_v(j) are functions of the ray and the line alone, and do not fall along the ray. All passings of a ray are thereby in one order:
//      by t, a v-line before a u-line where two are equal. Which cell the ray is in between two passings follows from that order alone.
//   2. F at a passing is one expression in the ray, the line and the cell at that place in the order, the same bits in both cells that share the
//      edge, in the same block or in two. So signs form one chain along the ray; if two of them differ, two neighbours in the chain do, and that
//      piece is reported. Where two blocks meet both see the same value, and a block whose stretch is empty (a corner) is still walked.
//   3. The diagonal's passing lies inside its cell: which triangles a ray visits follows from the edges by which it comes and goes, and its t is put
//      between them.
//   4. A block or a cell is left out only when the whole ray in it is above (below) all its nodes by more than the rounding of 2, so that every sign
//      left out would have been + (-).
// Within a piece F is linear: t = ta + (tb - ta) fa / (fa - fb). The rounding of F is at most 2^-46 of the sizes that enter it (height_error()).
// Deviation from Tevs2008: no smooth surface, no texture unit; the levels of the pyramid above a block are the tracer's tree of boxes.
#include "terrain/march/grid_rays.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

constexpr double kRounding = 0x1p-46;  // 64 roundings of 2^-52: the longest chain of operations has fewer than 20
constexpr double kStill = 1e-200;      // cells a metre: slower than this a ray does not leave its column within any finite length

enum class At { plane, u_line, v_line };  // what ends a piece: nothing of the grid, or the passing of a line

}  // namespace

GridRay::GridRay(const HeightGrid& grid, const Ray& ray) : grid_(grid), ray_(ray)
{
    const GridFrame& frame = grid.frame();
    const auto axis = [](double start, double speed) {
        const bool moves = std::abs(speed) > kStill;
        return Axis{start, moves ? speed : 0.0, moves ? 1.0 / speed : 0.0, moves ? (speed > 0.0 ? 1 : -1) : 0};
    };
    const Vec3d& k = grid.per_metre();
    u_ = axis((ray.origin.x - frame.origin.x) * k.x, ray.direction.x * k.x);
    v_ = axis((ray.origin.y - frame.origin.y) * k.y, ray.direction.y * k.y);
    z_ = (ray.origin.z - frame.origin.z) * k.z;
    dz_ = ray.direction.z * k.z;
}

double GridRay::height_error() const
{
    const GridSummary& all = grid_.whole();
    const double span = static_cast<double>(all.hi) - all.lo, far = std::abs(u_.start) + std::abs(v_.start) + grid_.columns() + grid_.rows();
    const double own = grid_.frame().scale * kRounding * (std::abs(z_) + std::max(std::abs(all.lo), std::abs(all.hi)) + far * span);
    return own + 0x1p-50 * std::abs(grid_.frame().origin.z);
}

/// The walk through one block; T is the type of its samples.
template <class T>
class BlockWalk
{
public:
    BlockWalk(const GridRay& ray, int block)
        : r_(ray),
          nodes_(ray.grid_.block<T>(block)),
          known_(ray.grid_.summary(block)),
          i_lo_(block % ray.grid_.blocks_across() * HeightGrid::kBlock),
          j_lo_(block / ray.grid_.blocks_across() * HeightGrid::kBlock),
          i_hi_(std::min(i_lo_ + HeightGrid::kBlock, ray.grid_.columns() - 1)),
          j_hi_(std::min(j_lo_ + HeightGrid::kBlock, ray.grid_.rows() - 1))
    {
        const double span = static_cast<double>(known_.hi) - known_.lo;
        margin_ = kRounding * (std::abs(r_.z_) + std::max(std::abs(known_.lo), std::abs(known_.hi)) +
                               (std::abs(r_.u_.start) + std::abs(r_.v_.start) + i_hi_ + j_hi_) * span);
    }

    bool first(double limit, GridCrossing& found, std::uint32_t& cells)
    {
        if (!enter() || !clip_height() || a_ >= limit) return false;
        place();
        // Nothing in this loop but what every cell needs, in local variables; a choice between u and v is not to be predicted, so it is no branch.
        const int u_step = r_.u_.step, v_step = r_.v_.step;
        const double u_next = u_step, v_next = v_step, u_start = r_.u_.start, v_start = r_.v_.start, z = r_.z_, dz = r_.dz_, margin = margin_;
        // A ray that stands still passes its next line never: (inf - start) * 1.
        const double u_inverse = u_step ? r_.u_.inverse : 1.0, v_inverse = v_step ? r_.v_.inverse : 1.0;
        double u_line = u_step ? i_ + (u_step > 0) : kInfinity, v_line = v_step ? j_ + (v_step > 0) : kInfinity;
        double tu = (u_line - u_start) * u_inverse, tv = (v_line - v_start) * v_inverse;
        int u_left = u_step > 0 ? i_hi_ - 1 - i_ : i_ - i_lo_, v_left = v_step > 0 ? j_hi_ - 1 - j_ : j_ - j_lo_;
        const std::ptrdiff_t u_jump = u_step, v_jump = v_step * HeightGrid::kStride;
        const T* p = nodes_ + (j_ - j_lo_) * HeightGrid::kStride + (i_ - i_lo_);
        double a = a_, z_a = z + dz * a_;
        std::uint32_t count = 0;
        for (;;) {
            ++count;
            const bool by_v = tv <= tu, ends = std::min(tu, tv) > end_;
            const double b = ends ? end_ : std::min(tu, tv), z_b = z + dz * b;
            const double top = std::max(std::max(p[0], p[1]), std::max(p[HeightGrid::kStride], p[HeightGrid::kStride + 1]));
            if (std::min(z_a, z_b) > top + margin) {
                known_value_ = false;
            } else {
                const double bottom = std::min(std::min(p[0], p[1]), std::min(p[HeightGrid::kStride], p[HeightGrid::kStride + 1]));
                if (std::max(z_a, z_b) < bottom - margin) {
                    known_value_ = false;
                } else {
                    i_ = u_step > 0 ? i_hi_ - 1 - u_left : i_lo_ + u_left;
                    j_ = v_step > 0 ? j_hi_ - 1 - v_left : j_lo_ + v_left;
                    a_ = a, b_ = b;
                    if (cell(p, ends ? At::plane : by_v ? At::v_line : At::u_line, limit, found)) return cells += count, true;
                }
            }
            u_left -= !by_v, v_left -= by_v;
            if (ends || (u_left | v_left) < 0 || b >= limit) break;
            start_ = by_v ? At::v_line : At::u_line;
            p += by_v ? v_jump : u_jump;
            u_line += by_v ? 0.0 : u_next, v_line += by_v ? v_next : 0.0;
            tu = (u_line - u_start) * u_inverse, tv = (v_line - v_start) * v_inverse;
            a = b, z_a = z_b;
        }
        cells += count;
        return false;
    }

private:
    /// The passings by which the ray comes into the lines [lo, hi] of an axis and goes out. False if it stands still elsewhere.
    static bool span(const GridRay::Axis& axis, int lo, int hi, bool to_border, double& in, double& out)
    {
        if (axis.step == 0) return axis.start >= lo && (axis.start < hi || (to_border && axis.start == hi));
        in = axis.t(axis.step > 0 ? lo : hi);
        out = axis.t(axis.step > 0 ? hi : lo);
        return true;
    }

    /// The stretch [a_, end_] of the ray over the block and what it begins with. An empty one counts where its two passings are in order.
    bool enter()
    {
        double ui = -kInfinity, uo = kInfinity, vi = -kInfinity, vo = kInfinity;
        if (!span(r_.u_, i_lo_, i_hi_, i_hi_ == r_.grid_.columns() - 1, ui, uo) || !span(r_.v_, j_lo_, j_hi_, j_hi_ == r_.grid_.rows() - 1, vi, vo))
            return false;
        start_ = ui >= vi ? At::u_line : At::v_line;
        const double in = std::max(ui, vi), out = std::min(uo, vo);
        if (!(in < out) && !(in == out && !(start_ == At::u_line && vo <= uo))) return false;
        if (!(r_.ray_.t_min < out) || !(in < r_.ray_.t_max)) return false;
        a_ = in;
        if (r_.ray_.t_min > in || in == -kInfinity) a_ = r_.ray_.t_min, start_ = At::plane;
        end_ = std::min(out, r_.ray_.t_max);
        return true;
    }

    /// Cuts off what is certainly above or below all nodes.
    bool clip_height()
    {
        const double lo = known_.lo - 2.0 * margin_, hi = known_.hi + 2.0 * margin_;
        if (r_.dz_ == 0.0) return r_.z_ >= lo && r_.z_ <= hi;
        const double inverse = 1.0 / r_.dz_, t0 = (lo - r_.z_) * inverse, t1 = (hi - r_.z_) * inverse;
        const double in = std::min(t0, t1);
        if (in > a_) a_ = in, start_ = At::plane;
        end_ = std::min(end_, std::max(t0, t1));
        return a_ <= end_;
    }

    /// The cell in which the stretch begins: a guess, put right by the order of passings.
    void place()
    {
        i_ = cell_at(r_.u_, i_lo_, i_hi_ - 1, start_ == At::v_line);
        j_ = cell_at(r_.v_, j_lo_, j_hi_ - 1, false);
    }
    int cell_at(const GridRay::Axis& axis, int first, int last, bool later) const
    {
        const double guess = std::floor(axis.start + axis.speed * a_);
        int cell = guess >= last ? last : guess > first ? static_cast<int>(guess) : first;
        if (axis.step == 0) return cell;
        const int ahead = axis.step > 0 ? 1 : 0;
        const auto passed = [&](int line) { return later ? axis.t(line) < a_ : axis.t(line) <= a_; };
        const int end = axis.step > 0 ? last : first, begin = axis.step > 0 ? first : last;
        while (cell != end && passed(cell + ahead)) cell += axis.step;
        while (cell != begin && !passed(cell + 1 - ahead)) cell -= axis.step;
        return cell;
    }

    /// The cell (i_, j_), whose nodes begin at p, over the piece [a_, b_].
    bool cell(const T* p, At end, double limit, GridCrossing& found)
    {
        const double h00 = p[0], h10 = p[1], h01 = p[HeightGrid::kStride], h11 = p[HeightGrid::kStride + 1];
        const double z_a = r_.z_ + r_.dz_ * a_, z_b = r_.z_ + r_.dz_ * b_;
        const bool from_upper = is_upper(start_, a_, true), to_upper = is_upper(end, b_, false);
        const double fa = known_value_ ? f_ : z_a - over(start_, a_, from_upper, h00, h10, h01, h11);
        const double fb = z_b - over(end, b_, to_upper, h00, h10, h01, h11);
        f_ = fb;
        known_value_ = true;
        if (from_upper == to_upper) return piece(a_, fa, b_, fb, to_upper, limit, found);
        const double w = r_.u_.speed + r_.v_.speed;
        double t = 0.5 * (a_ + b_);
        if (w != 0.0) t = std::clamp((i_ + j_ + 1 - (r_.u_.start + r_.v_.start)) / w, a_, b_);
        const double along = r_.v_.start + r_.v_.speed * t - j_;
        const double fd = r_.z_ + r_.dz_ * t - (h10 + (h01 - h10) * along);
        return piece(a_, fa, t, fd, from_upper, limit, found) || piece(t, fd, b_, fb, to_upper, limit, found);
    }

    /// Which triangle of the cell lies at the end of a piece: by the edge, or by the point.
    bool is_upper(At at, double t, bool coming) const
    {
        if (at == At::u_line) return (r_.u_.step > 0) != coming;
        if (at == At::v_line) return (r_.v_.step > 0) != coming;
        return r_.u_.start + r_.u_.speed * t - i_ + (r_.v_.start + r_.v_.speed * t - j_) > 1.0;
    }

    /// Height of the ground at an end of a piece: along the edge that is passed, or in the plane of the triangle.
    double over(At at, double t, bool upper, double h00, double h10, double h01, double h11) const
    {
        const double u = r_.u_.start + r_.u_.speed * t - i_, v = r_.v_.start + r_.v_.speed * t - j_;
        if (at == At::u_line) return upper ? h10 + (h11 - h10) * v : h00 + (h01 - h00) * v;
        if (at == At::v_line) return upper ? h01 + (h11 - h01) * u : h00 + (h10 - h00) * u;
        return upper ? h11 + (h01 - h11) * (1.0 - u) + (h10 - h11) * (1.0 - v) : h00 + (h10 - h00) * u + (h01 - h00) * v;
    }

    bool piece(double ta, double fa, double tb, double fb, bool upper, double limit, GridCrossing& found) const
    {
        const bool from_matter = fa < 0.0, to_matter = fb < 0.0;
        if (from_matter == to_matter || (from_matter && r_.ray_.crossing == Crossing::entering)) return false;
        const double t = std::clamp(ta + (tb - ta) * (fa / (fa - fb)), ta, tb);
        if (!(t > r_.ray_.t_min && t < r_.ray_.t_max && t < limit)) return false;
        found = {t, i_, j_, upper, to_matter};
        return true;
    }

    const GridRay& r_;
    const T* nodes_;
    GridSummary known_;
    int i_lo_, j_lo_, i_hi_, j_hi_;
    double margin_ = 0.0;
    double a_ = 0.0, b_ = 0.0, end_ = 0.0;  // the piece [a_, b_] of the stretch that ends at end_
    double f_ = 0.0;                        // F at a_, if known_value_
    bool known_value_ = false;
    At start_ = At::plane;
    int i_ = 0, j_ = 0;
};

bool GridRay::first_in_block(int block, double limit, GridCrossing& found, std::uint32_t& cells) const
{
    switch (grid_.type()) {
        case SampleType::u8:
            return BlockWalk<std::uint8_t>(*this, block).first(limit, found, cells);
        case SampleType::u16:
            return BlockWalk<std::uint16_t>(*this, block).first(limit, found, cells);
        case SampleType::i16:
            return BlockWalk<std::int16_t>(*this, block).first(limit, found, cells);
        case SampleType::f32:
            return BlockWalk<float>(*this, block).first(limit, found, cells);
    }
    return false;
}

Box3d block_bounds(const HeightGrid& grid, int block)
{
    const GridFrame& frame = grid.frame();
    const GridSummary& known = grid.summary(block);
    const int i = block % grid.blocks_across() * HeightGrid::kBlock, j = block / grid.blocks_across() * HeightGrid::kBlock;
    const int i_end = std::min(i + HeightGrid::kBlock, grid.columns() - 1), j_end = std::min(j + HeightGrid::kBlock, grid.rows() - 1);
    Box3d box(frame.origin + Vec3d(i * frame.cell.x, j * frame.cell.y, frame.scale * known.lo),
              frame.origin + Vec3d(i_end * frame.cell.x, j_end * frame.cell.y, frame.scale * known.hi));
    const auto size = [](const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    const Vec3d pad(0x1p-44 * (size(frame.origin) + size(box.min) + size(box.max)));
    return {box.min - pad, box.max + pad};
}

}  // namespace hoodoo
