// Sums over the columns under a kernel (Peytavie2009, section 3.3): f = 1 - scale * sum_ij w_i(X) w_j(Y) D_ij(Z).
//
// w is the width of a column under the kernel, D the thickness of its matter between Z - height and Z + height: both are piecewise linear, so along
// a ray, between the points where one of them bends, f is a cubic (maths of stacks, A2). Its Bernstein coefficients are sums of products of
// the end values: no differences, hence no cancellation.
// Four lanes in a fixed order: the same bits from every tile and on every processor.

#include "terrain/march/column_tile.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace hoodoo
{
namespace
{

constexpr std::size_t kLanes = 4;

/// The compiler's own vectors: the same operations in the same order on every processor.
using Lanes = double __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(16)));

inline Lanes load(const double* from)
{
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

inline Lanes load(const std::int32_t* from)
{
    IntLanes v;
    std::memcpy(&v, from, sizeof v);
    return __builtin_convertvector(v, Lanes);
}

inline Lanes spread(double x)
{
    return Lanes{x, x, x, x};
}
inline double total(const Lanes& v)
{
    return (v[0] + v[1]) + (v[2] + v[3]);
}

/// max(0, min(top, high) - low) of each lane.
inline Lanes filled(const Lanes& top, const Lanes& high, const Lanes& low)
{
    const Lanes d = (top < high ? top : high) - low, zero{};
    return d > zero ? d : zero;
}

/// Part of [bottom, top] that a column's run [low, high] fills.
inline double filled(double low, double high, double bottom, double top)
{
    return std::max(0.0, std::min(high, top) - std::max(low, bottom));
}

}  // namespace

/// Overlaps along x, padded with zeros to whole lanes. Small kernels need no heap.
class ColumnTile::Weights
{
public:
    Weights(const KernelFrame& frame, double x, int first, int last)
    {
        const auto n = static_cast<std::size_t>(last - first + 1);
        if (n + kLanes > small_.size()) large_.resize(n + kLanes);
        data_ = large_.empty() ? small_.data() : large_.data();
        set(frame, x, first, n);
    }
    Weights(const Weights&) = delete;
    Weights& operator=(const Weights&) = delete;
    /// Columns behind the last one come out as zero.
    void set(const KernelFrame& frame, double x, int first, std::size_t n)
    {
        const Lanes low = spread(x - frame.reach), high = spread(x + frame.reach);
        const double i = first;
        Lanes left{i, i + 1.0, i + 2.0, i + 3.0};
        for (std::size_t k = 0; k < n; k += kLanes) {
            const Lanes from = left > low ? left : low, w = filled(left + spread(1.0), high, from);
            std::memcpy(data_ + k, &w, sizeof w);
            left += spread(static_cast<double>(kLanes));
        }
    }
    const double* data() const { return data_; }

private:
    std::array<double, 20> small_;
    std::vector<double> large_;
    double* data_;
};

/// Heights in ascending order.
class ColumnTile::Bends
{
public:
    void add(double z)
    {
        if (count_ < small_.size())
            small_[count_++] = z;
        else
            add_large(z);
    }
    void sort() { std::sort(begin(), begin() + count_); }
    std::size_t size() const { return count_; }
    double operator[](std::size_t k) const { return large_.empty() ? small_[k] : large_[k]; }

private:
    double* begin() { return large_.empty() ? small_.data() : large_.data(); }
    void add_large(double z)
    {
        if (large_.empty()) large_.assign(small_.begin(), small_.end());
        large_.push_back(z);
        ++count_;
    }
    std::array<double, 64> small_;
    std::vector<double> large_;
    std::size_t count_ = 0;
};

ColumnTile::ColumnTile(const Ground& ground, Vec2i from, Vec2i to) : from_(from), to_(to)
{
    // Lanes may read beyond the last column of a row, with weight zero.
    stride_ = static_cast<std::size_t>(to.x - from.x) + kLanes;
    const auto rows = static_cast<std::size_t>(to.y - from.y);
    base_.reserve(stride_ * rows);
    offset_.reserve(stride_ * rows + 1);
    const std::int32_t floor = ground.floor();
    for (int j = from.y; j < to.y; ++j) {
        for (int i = from.x; i < from.x + static_cast<int>(stride_); ++i) {
            offset_.push_back(static_cast<std::uint32_t>(runs_.size()));
            std::int32_t base = floor;
            if (i < to.x) {
                ground.for_each_run(i, j, [&](const Run& run) {
                    if (run.bottom == floor)
                        base = run.top;
                    else
                        runs_.push_back({run.bottom, run.top, i});
                });
            }
            base_.push_back(base);
        }
    }
    offset_.push_back(static_cast<std::uint32_t>(runs_.size()));
    runs_.shrink_to_fit();
}

std::uint64_t ColumnTile::memory_bytes() const
{
    return base_.capacity() * sizeof(base_[0]) + offset_.capacity() * sizeof(offset_[0]) + runs_.capacity() * sizeof(PlacedRun);
}

Vec3d ColumnTile::confine(const KernelFrame& frame, const Vec3d& p) const
{
    constexpr double hair = 1e-6;
    return {std::clamp(p.x, from_.x + frame.reach, to_.x - frame.reach - hair), std::clamp(p.y, from_.y + frame.reach, to_.y - frame.reach - hair),
            p.z};
}

double ColumnTile::value(const KernelFrame& frame, const Vec3d& where) const
{
    const Vec3d p = confine(frame, where);
    const int i0 = frame.first_column(p.x), i1 = frame.last_column(p.x), j0 = frame.first_column(p.y), j1 = frame.last_column(p.y);
    const Weights weights(frame, p.x, i0, i1);
    const double* wx = weights.data();
    const double bottom = std::max(p.z - frame.height, frame.floor), top = p.z + frame.height;
    const auto n = static_cast<std::size_t>(i1 - i0 + 1);
    const Lanes low = spread(bottom), high = spread(top);
    Lanes sum{};
    double others = 0.0;
    for (int j = j0; j <= j1; ++j) {
        const double wy = frame.overlap(p.y, j);
        const std::size_t row = index(i0, j);
        const std::int32_t* base = &base_[row];
        Lanes lane{};
        for (std::size_t k = 0; k < n; k += kLanes) lane += load(wx + k) * filled(load(base + k), high, low);
        sum += lane * wy;
        for (std::uint32_t r = offset_[row]; r < offset_[row + n]; ++r)
            others += wy * wx[runs_[r].column - i0] * filled(runs_[r].bottom, runs_[r].top, bottom, top);
    }
    return 1.0 - frame.scale * (total(sum) + others) - KernelFrame::delta;
}

void ColumnTile::collect_bends(const KernelFrame& frame, const Window& w, double z0, double z1, Bends& bends) const
{
    const auto consider = [&](double bound) {
        const double lower = bound - frame.height, upper = bound + frame.height;
        if (lower > z0 && lower < z1) bends.add(lower);
        if (upper > z0 && upper < z1) bends.add(upper);
    };
    consider(frame.floor);
    const auto n = static_cast<std::size_t>(w.i1 - w.i0 + 1);
    for (int j = w.j0; j <= w.j1; ++j) {
        const std::size_t row = index(w.i0, j);
        for (std::size_t k = 0; k < n; k += kLanes) {
            // Most columns bend elsewhere: look at four at a time.
            const Lanes top = load(&base_[row + k]), lower = top - spread(frame.height), upper = top + spread(frame.height);
            const auto near = ((lower > spread(z0)) & (lower < spread(z1))) | ((upper > spread(z0)) & (upper < spread(z1)));
            for (std::size_t l = 0; l < std::min(kLanes, n - k); ++l)
                if (near[l]) consider(base_[row + k + l]);
        }
        for (std::uint32_t r = offset_[row]; r < offset_[row + n]; ++r) consider(runs_[r].bottom), consider(runs_[r].top);
    }
    bends.sort();
}

Cubic ColumnTile::piece(const KernelFrame& frame, const Window& w, const Weights& ax, const Weights& bx, const Vec3d& a, const Vec3d& b) const
{
    const double *wa = ax.data(), *wb = bx.data();
    const auto n = static_cast<std::size_t>(w.i1 - w.i0 + 1);
    const double bottom_a = std::max(a.z - frame.height, frame.floor), top_a = a.z + frame.height;
    const double bottom_b = std::max(b.z - frame.height, frame.floor), top_b = b.z + frame.height;
    const Lanes low_a = spread(bottom_a), high_a = spread(top_a), low_b = spread(bottom_b), high_b = spread(top_b);
    Cubic sum{};
    for (int j = w.j0; j <= w.j1; ++j) {
        // Row: the sum of products of two linear functions, in Bernstein form of degree 2 (the middle coefficient twice).
        const std::size_t row = index(w.i0, j);
        const std::int32_t* base = &base_[row];
        Lanes l0{}, l1{}, l2{};
        for (std::size_t k = 0; k < n; k += kLanes) {
            const Lanes top = load(base + k), va = load(wa + k), vb = load(wb + k);
            const Lanes da = filled(top, high_a, low_a), db = filled(top, high_b, low_b);
            l0 += va * da;
            l1 += va * db + vb * da;
            l2 += vb * db;
        }
        double q0 = total(l0), q1 = total(l1), q2 = total(l2);
        for (std::uint32_t r = offset_[row]; r < offset_[row + n]; ++r) {
            const int k = runs_[r].column - w.i0;
            const double da = filled(runs_[r].bottom, runs_[r].top, bottom_a, top_a), db = filled(runs_[r].bottom, runs_[r].top, bottom_b, top_b);
            q0 += wa[k] * da;
            q1 += wa[k] * db + wb[k] * da;
            q2 += wb[k] * db;
        }
        // Times the row's own weight: degree 3.
        const double ya = frame.overlap(a.y, j), yb = frame.overlap(b.y, j);
        sum[0] += q0 * ya;
        sum[1] += q1 * ya + q0 * yb;
        sum[2] += q2 * ya + q1 * yb;
        sum[3] += q2 * yb;
    }
    sum[1] /= 3.0, sum[2] /= 3.0;
    for (double& c : sum) c = 1.0 - frame.scale * c - KernelFrame::delta;
    return sum;
}

bool ColumnTile::first_change(const KernelFrame& frame, const FrameRay& ray, double ta, double tb, Start start, double& t, double& value,
                              std::uint32_t& evaluations) const
{
    // The columns under the kernel are those of the middle of the segment.
    const Vec3d middle = confine(frame, ray.at(0.5 * (ta + tb)));
    const Window w{frame.first_column(middle.x), frame.last_column(middle.x), frame.first_column(middle.y), frame.last_column(middle.y)};

    // Piece by piece, from one bend in height to the next.
    const Vec3d end = ray.at(tb);
    Vec3d a = ray.at(ta);
    const bool up = ray.direction.z > 0.0;
    Bends bends;
    if (ray.direction.z != 0.0) collect_bends(frame, w, std::min(a.z, end.z), std::max(a.z, end.z), bends);
    const auto n = static_cast<std::size_t>(w.i1 - w.i0 + 1);
    Weights first(frame, a.x, w.i0, w.i1), second(frame, a.x, w.i0, w.i1);
    Weights *wa = &first, *wb = &second;
    for (std::size_t k = 0; k <= bends.size(); ++k) {
        const bool last = k == bends.size();
        double te = tb;
        Vec3d e = end;
        if (!last) {
            const double bend = bends[up ? k : bends.size() - 1 - k];
            if (bend == a.z) continue;
            te = std::clamp((bend - ray.origin.z) / ray.direction.z, ta, tb);
            e = ray.at(te);
            e.z = bend;
        }
        wb->set(frame, e.x, w.i0, n);
        Cubic c = piece(frame, w, *wa, *wb, a, e);
        ++evaluations;
        if (start.on_surface) c[0] = 0.0;
        double u = 0.0;
        if (hoodoo::first_change(c, start.inside, u)) {
            t = ta + (te - ta) * u;
            return true;
        }
        value = c[3];
        start.on_surface = false;
        a = e;
        ta = te;
        std::swap(wa, wb);
    }
    return false;
}

}  // namespace hoodoo
