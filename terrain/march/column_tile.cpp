// Sums over the columns under a kernel (Peytavie2009, section 3.3): f = 1 - scale * sum_ij w_i(X) w_j(Y) D_ij(Z).
//
// w is the width of a column under the kernel, D the thickness of its matter between Z - height and Z + height: both are piecewise linear, so along
// a ray, between the points where one of them bends, f is a cubic (maths of stacks, A2). Its Bernstein coefficients are sums of products of
// the end values: no differences, hence no cancellation.
// Four lanes in a fixed order: the same bits from every tile and on every processor.

#include "terrain/march/column_tile.h"

#include <algorithm>
#include <array>

namespace hoodoo {
namespace {

constexpr std::size_t kLanes = 4;

/// Weights along one axis, padded with zeros to whole lanes. Small kernels need no heap.
class Weights {
public:
    Weights(const KernelFrame& frame, double x, int first, int last)
    {
        const auto n = static_cast<std::size_t>(last - first + 1);
        if (n + kLanes > small_.size()) large_.assign(n + kLanes, 0.0);
        double* w = large_.empty() ? small_.data() : large_.data();
        for (std::size_t k = 0; k < n; ++k) w[k] = frame.overlap(x, first + static_cast<int>(k));
        for (std::size_t k = n; k < n + kLanes; ++k) w[k] = 0.0;
        data_ = w;
    }
    Weights(const Weights&) = delete;
    Weights& operator=(const Weights&) = delete;
    double operator[](std::size_t k) const { return data_[k]; }

private:
    std::array<double, 20> small_;
    std::vector<double> large_;
    const double* data_;
};

}  // namespace

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
                    if (run.bottom == floor) base = run.top;
                    else runs_.push_back(run);
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
    return base_.capacity() * sizeof(base_[0]) + offset_.capacity() * sizeof(offset_[0]) + runs_.capacity() * sizeof(Run);
}

Vec3d ColumnTile::confine(const KernelFrame& frame, const Vec3d& p) const
{
    constexpr double hair = 1e-6;
    return {std::clamp(p.x, from_.x + frame.reach, to_.x - frame.reach - hair), std::clamp(p.y, from_.y + frame.reach, to_.y - frame.reach - hair), p.z};
}

double ColumnTile::value(const KernelFrame& frame, const Vec3d& where) const
{
    const Vec3d p = confine(frame, where);
    const int i0 = frame.first_column(p.x), i1 = frame.last_column(p.x), j0 = frame.first_column(p.y), j1 = frame.last_column(p.y);
    const Weights wx(frame, p.x, i0, i1);
    const double bottom = std::max(p.z - frame.height, frame.floor), top = p.z + frame.height;
    const auto n = static_cast<std::size_t>(i1 - i0 + 1);
    std::array<double, kLanes> sum{};
    double others = 0.0;
    for (int j = j0; j <= j1; ++j) {
        const double wy = frame.overlap(p.y, j);
        const std::size_t row = index(i0, j);
        std::array<double, kLanes> lane{};
        for (std::size_t k = 0; k < n; k += kLanes)
            for (std::size_t l = 0; l < kLanes; ++l)
                lane[l] += wx[k + l] * std::max(0.0, std::min(static_cast<double>(base_[row + k + l]), top) - bottom);
        for (std::size_t l = 0; l < kLanes; ++l) sum[l] += wy * lane[l];
        if (offset_[row] == offset_[row + n]) continue;
        for (std::size_t k = 0; k < n; ++k)
            for (std::uint32_t r = offset_[row + k]; r < offset_[row + k + 1]; ++r)
                others += wy * wx[k] * std::max(0.0, std::min<double>(runs_[r].top, top) - std::max<double>(runs_[r].bottom, bottom));
    }
    return 1.0 - frame.scale * (((sum[0] + sum[1]) + (sum[2] + sum[3])) + others) - KernelFrame::delta;
}

double ColumnTile::thickness(const KernelFrame& frame, std::size_t column, double z) const
{
    const double bottom = std::max(z - frame.height, frame.floor), top = z + frame.height;
    double sum = std::max(0.0, std::min<double>(base_[column], top) - bottom);
    for (std::uint32_t r = offset_[column]; r < offset_[column + 1]; ++r)
        sum += std::max(0.0, std::min<double>(runs_[r].top, top) - std::max<double>(runs_[r].bottom, bottom));
    return sum;
}

double ColumnTile::next_bend(const KernelFrame& frame, const Window& w, double z, bool up) const
{
    double next = up ? kInfinity : -kInfinity;
    const auto consider = [&](double bound) {
        for (const double at : {bound - frame.height, bound + frame.height}) {
            if (up ? (at > z && at < next) : (at < z && at > next)) next = at;
        }
    };
    consider(frame.floor);
    for (int j = w.j0; j <= w.j1; ++j) {
        const std::size_t row = index(w.i0, j);
        const auto n = static_cast<std::size_t>(w.i1 - w.i0 + 1);
        for (std::size_t k = 0; k < n; ++k) consider(base_[row + k]);
        for (std::uint32_t r = offset_[row]; r < offset_[row + n]; ++r) consider(runs_[r].bottom), consider(runs_[r].top);
    }
    return next;
}

Cubic ColumnTile::piece(const KernelFrame& frame, const Window& w, const Vec3d& a, const Vec3d& b) const
{
    const Weights ax(frame, a.x, w.i0, w.i1), bx(frame, b.x, w.i0, w.i1);
    Cubic sum{};
    for (int j = w.j0; j <= w.j1; ++j) {
        // Row: the product of two linear functions, in Bernstein form of degree 2 (the middle coefficient twice).
        const std::size_t row = index(w.i0, j);
        double q0 = 0.0, q1 = 0.0, q2 = 0.0;
        for (std::size_t k = 0; k <= static_cast<std::size_t>(w.i1 - w.i0); ++k) {
            const double da = thickness(frame, row + k, a.z), db = thickness(frame, row + k, b.z);
            q0 += ax[k] * da;
            q1 += ax[k] * db + bx[k] * da;
            q2 += bx[k] * db;
        }
        // Times the row's own weight: degree 3.
        const double wa = frame.overlap(a.y, j), wb = frame.overlap(b.y, j);
        sum[0] += q0 * wa;
        sum[1] += (q1 * wa + q0 * wb) / 3.0;
        sum[2] += (q2 * wa + q1 * wb) / 3.0;
        sum[3] += q2 * wb;
    }
    for (double& c : sum) c = 1.0 - frame.scale * c - KernelFrame::delta;
    return sum;
}

bool ColumnTile::first_change(const KernelFrame& frame, const FrameRay& ray, double ta, double tb, Start start, double& t, double& value,
                              std::uint32_t& evaluations) const
{
    // The columns under the kernel are those of the middle of the segment.
    const Vec3d middle = confine(frame, ray.at(0.5 * (ta + tb)));
    const Window w{frame.first_column(middle.x), frame.last_column(middle.x), frame.first_column(middle.y), frame.last_column(middle.y)};

    // Piece by piece, from one bend in height to the next. Heights increase (or decrease) strictly: the number of pieces is finite.
    const bool up = ray.direction.z > 0.0;
    Vec3d a = ray.at(ta);
    const Vec3d end = ray.at(tb);
    for (;;) {
        double bend = ray.direction.z == 0.0 ? kInfinity : next_bend(frame, w, a.z, up);
        const bool last = ray.direction.z == 0.0 || (up ? bend >= end.z : bend <= end.z);
        const double te = last ? tb : std::clamp((bend - ray.origin.z) / ray.direction.z, ta, tb);
        Vec3d e = last ? end : ray.at(te);
        if (!last) e.z = bend;
        Cubic c = piece(frame, w, a, e);
        ++evaluations;
        if (start.on_surface) c[0] = 0.0;
        double u = 0.0;
        if (hoodoo::first_change(c, start.inside, u)) {
            t = ta + (te - ta) * u;
            return true;
        }
        if (last) {
            value = c[3];
            return false;
        }
        start.on_surface = false;
        a = e;
        ta = te;
    }
}

}  // namespace hoodoo
