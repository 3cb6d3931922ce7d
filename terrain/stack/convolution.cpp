// The field of a layer stack: how much of a cube around a point is matter, computed column by column from the integer heights.
// Peytavie2009, section 3.3. With C the cumulated matter of a column, w the overlap of a column's cell with the cube:
//   D_ij(z) = C_ij(z + sigma) - C_ij(z - sigma),   V = sum_ij w_i(x) w_j(y) D_ij(z),   f = 1 - V / (4 sigma^3).
// Inside, lengths are in cells (x, y) and height units (z), so that V / (8 sigma^3) is a mean of D / (2 sigma) with weights that sum to 1.
// Deviations: the sign (negative inside); the paper's kernel is closed, here it is closed below and open above (the measure is the same).
// Bounds: along x, df/dx = -(1/(4 sigma^3)) sum_j w_j (D at the right face - D at the left face): a weighted mean of differences, so the extreme
// differences bound it; likewise y and z. Missing: nothing of 3.3; its polygonisation is not needed.
#include "terrain/stack/convolution.h"

#include "terrain/stack/window.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <utility>

namespace hoodoo
{

namespace
{

/// Rounding of value() and of the bounds: at most 50 columns or layers are summed with relative error 2^-53 each.
constexpr double kRounding = 1e-12;
/// Beyond this many columns a box is bounded by the kernel alone.
constexpr double kMaxColumns = 4096.0;

/// Extreme directional derivatives and values over a box.
struct Local {
    Interval dx, dy, dz, value;
};

struct Hull {
    Interval i{kInfinity, -kInfinity};
    void add(double x) { add(Interval{x, x}); }
    void add(const Interval& o) { i = {std::min(i.lo, o.lo), std::max(i.hi, o.hi)}; }
};

Interval difference(const Interval& a, const Interval& b)
{
    return {a.lo - b.hi, a.hi - b.lo};
}

/// Whether column (i, j) is matter, as a range over [low, high] in units.
Interval presence(const Ground& ground, int i, int j, double low, double high)
{
    double lo = 0.0, hi = 0.0;
    ground.for_each_run(i, j, [&](Run run) {
        if (run.bottom <= low && high < run.top) lo = 1.0;
        if (run.bottom <= high && low < run.top) hi = 1.0;
    });
    return {lo, hi};
}

}  // namespace

ConvolutionField::ConvolutionField(Ground ground, double sigma) : ground_(std::move(ground)), sigma_(sigma)
{
    if (!(std::isfinite(sigma) && sigma > 0.0 && sigma <= 64.0 * ground_.stack().cell())) {
        throw Error(ErrorKind::scene, Problem{{}, "kernel half-width sigma", "a positive length of at most 64 cells", fmt::to_string(sigma), {}});
    }
}

namespace
{

/// What the kernel sees around a point: the windows of the three axes, x and y in cells, z in units.
struct View {
    View(const Ground& ground, double sigma, const Vec3d& p)
        : half(sigma / ground.stack().cell()),
          tall(sigma / ground.stack().unit()),
          x(window((p.x - ground.stack().origin().x) / ground.stack().cell(), half, ground.stack().size().x)),
          y(window((p.y - ground.stack().origin().y) / ground.stack().cell(), half, ground.stack().size().y)),
          z((p.z - ground.stack().origin().z) / ground.stack().unit())
    {
    }
    double half, tall;
    Window x, y;
    double z;
};

}  // namespace

double ConvolutionField::value(const Vec3d& p) const
{
    const View v(ground_, sigma_, p);
    double volume = 0.0;
    for (int j = v.y.first; j <= v.y.last; ++j) {
        double row = 0.0;
        for (int i = v.x.first; i <= v.x.last; ++i) row += v.x.weight(i) * ground_.length(i, j, v.z - v.tall, v.z + v.tall);
        volume += v.y.weight(j) * row;
    }
    // f = 1 - V/(4 sigma^3), V in cells^2 units.
    return std::clamp(1.0 - volume / (4.0 * v.half * v.half * v.tall), -1.0, 1.0);
}

Vec3d ConvolutionField::gradient(const Vec3d& p) const
{
    const View v(ground_, sigma_, p);
    const double low = v.z - v.tall, high = v.z + v.tall, begin = std::min(std::max<double>(ground_.floor(), low), high);
    Vec3d g(0.0);
    // dV/dx = sum_j w_j (D_right,j - D_left,j), dV/dy likewise, dV/dz = sum_ij w_i w_j (g_ij(z + sigma) - g_ij(z - sigma)).
    for (int j = v.y.first; j <= v.y.last; ++j) {
        const double wy = v.y.weight(j), side_y = (j == v.y.last) - (j == v.y.first);
        for (int i = v.x.first; i <= v.x.last; ++i) {
            double d = 0.0, from = begin;
            int change = 0;
            ground_.for_each_layer(i, j, [&](std::int32_t bottom, std::int32_t top, bool in) {
                const double to = std::min(std::max<double>(top, low), high);
                d += in ? to - from : 0.0;
                from = to;
                change += in * ((bottom <= high) & (high < top)) - in * ((bottom <= low) & (low < top));
            });
            const double wx = v.x.weight(i), side_x = (i == v.x.last) - (i == v.x.first);
            g += Vec3d(side_x * wy * d, side_y * wx * d, wx * wy * change);
        }
    }
    const MaterialStack& stack = ground_.stack();
    const double scale = -1.0 / (4.0 * v.half * v.half * v.tall);
    return Vec3d(g.x / stack.cell(), g.y / stack.cell(), g.z / stack.unit()) * scale;
}

namespace
{

/// Bounds over a box of few columns. Every number is an extreme over the columns that the kernel touches from somewhere in the box.
Local local_bounds(const Ground& ground, double sigma, const Box3d& box)
{
    const MaterialStack& stack = ground.stack();
    const double s = stack.cell(), half = sigma / s, tall = sigma / stack.unit();
    const double free = 1.0 / sigma;
    Local local{{-free, free}, {-free, free}, {-free, free}, {-1.0, 1.0}};
    const auto u = [&](double x, double origin, int n) { return confined((x - origin) / s, half, n); };
    const Vec2i n = stack.size();
    const double x0 = u(box.min.x, stack.origin().x, n.x), x1 = u(box.max.x, stack.origin().x, n.x);
    const double y0 = u(box.min.y, stack.origin().y, n.y), y1 = u(box.max.y, stack.origin().y, n.y);
    if ((x1 - x0 + 2 * half + 2) * (y1 - y0 + 2 * half + 2) > kMaxColumns) return local;
    const double z0 = (box.min.z - stack.origin().z) / stack.unit(), z1 = (box.max.z - stack.origin().z) / stack.unit();
    // The kernel's left face lies in columns left.x..left.y, its right face in right.x..right.y; a guard of 1e-9 cells covers the rounding of u.
    const auto columns = [](double a, double b) { return Vec2i(static_cast<int>(std::floor(a - 1e-9)), static_cast<int>(std::floor(b + 1e-9))); };
    const Vec2i left = columns(x0 - half, x1 - half), right = columns(x0 + half, x1 + half);
    const Vec2i front = columns(y0 - half, y1 - half), back = columns(y0 + half, y1 + half);

    // D of one column over the heights of the box. `all` spans every window [z - sigma, z + sigma], `common` is in each of them: a window holds at
    // least the matter of `common` and lacks at most the air of `all`, and the other way round.
    const double span = z1 - z0 + 2.0 * tall, common = std::max(0.0, 2.0 * tall - (z1 - z0));
    const auto matter = [&](int i, int j) {
        const double all = ground.length(i, j, z0 - tall, z1 + tall), shared = common > 0.0 ? ground.length(i, j, z1 - tall, z0 + tall) : 0.0;
        return Interval{std::max(shared, 2.0 * tall - (span - all)), std::min(all, 2.0 * tall - (common - shared))};
    };
    const auto in = [](const Vec2i& range, int i) { return range.x <= i && i <= range.y; };
    Hull dx, dy, dz, value;
    std::vector<Interval> front_of(static_cast<std::size_t>(right.y - left.x + 1), Interval{kInfinity, -kInfinity}), back_of = front_of;
    for (int j = front.x; j <= back.y; ++j) {
        Hull at_left, at_right;
        for (int i = left.x; i <= right.y; ++i) {
            const Interval d = matter(i, j);
            const std::size_t k = static_cast<std::size_t>(i - left.x);
            value.add(d);
            if (in(left, i)) at_left.add(d);
            if (in(right, i)) at_right.add(d);
            if (in(front, j)) front_of[k] = Interval::hull(front_of[k], d);
            if (in(back, j)) back_of[k] = Interval::hull(back_of[k], d);
            dz.add(difference(presence(ground, i, j, z0 + tall, z1 + tall), presence(ground, i, j, z0 - tall, z1 - tall)));
        }
        dx.add(difference(at_right.i, at_left.i));
    }
    for (std::size_t k = 0; k < front_of.size(); ++k) dy.add(difference(back_of[k], front_of[k]));
    // df/dx = -(2 sigma)(D_right - D_left)/(4 sigma^3) for a mean over the rows, in metres; df/dz = -(2 sigma)^2 (g_up - g_low)/(4 sigma^3).
    const double per_unit = -stack.unit() / (2.0 * sigma * sigma);
    const auto limited = [&](const Interval& i) { return Interval{std::max(i.lo, -free), std::min(i.hi, free)}; };
    local.dx = limited(dx.i.scaled(per_unit));
    local.dy = limited(dy.i.scaled(per_unit));
    local.dz = limited(dz.i.scaled(-free));
    local.value = {1.0 - value.i.hi / tall, 1.0 - value.i.lo / tall};
    return local;
}

double magnitude(const Interval& i)
{
    return std::max(std::abs(i.lo), std::abs(i.hi));
}

}  // namespace

double ConvolutionField::slope_bound(const Segment& segment) const
{
    const Vec3d step = segment.b - segment.a;
    const double length = step.length();
    if (!(length > 0.0) || !std::isfinite(length)) return std::sqrt(3.0) / sigma_;
    Box3d box(segment.a);
    box.extendBy(segment.b);
    const Local local = local_bounds(ground_, sigma_, box);
    const Interval along = local.dx.scaled(step.x / length) + local.dy.scaled(step.y / length) + local.dz.scaled(step.z / length);
    return magnitude(along) + kRounding / sigma_;
}

Interval ConvolutionField::range(const Box3d& box) const
{
    if (box.isEmpty()) return {1.0, 1.0};
    const Local local = local_bounds(ground_, sigma_, box);
    Interval found = {std::max(local.value.lo, -1.0), std::min(local.value.hi, 1.0)};
    const Vec3d half = box.size() * 0.5;
    const double reach = half.x * magnitude(local.dx) + half.y * magnitude(local.dy) + half.z * magnitude(local.dz);
    if (std::isfinite(reach)) {
        const double centre = value(box.center());
        found = {std::max(found.lo, centre - reach), std::min(found.hi, centre + reach)};
    }
    return {std::max(-1.0, found.lo - kRounding), std::min(1.0, found.hi + kRounding)};
}

std::array<Interval, 3> ConvolutionField::gradient_range(const Box3d& box) const
{
    const Local local = local_bounds(ground_, sigma_, box);
    const auto widened = [&](const Interval& i) { return Interval{i.lo - kRounding / sigma_, i.hi + kRounding / sigma_}; };
    return {widened(local.dx), widened(local.dy), widened(local.dz)};
}

Box3d ConvolutionField::bounds() const
{
    const MaterialStack& stack = ground_.stack();
    const double top = stack.origin().z + stack.highest_top() * stack.unit();
    if (ground_.border() == Border::extend) return Box3d(Vec3d(-kInfinity), Vec3d(kInfinity, kInfinity, top));
    // Beyond a face of the block more than half of the cube is air.
    const Vec2i n = stack.size();
    return Box3d(stack.origin() + Vec3d(0, 0, ground_.floor() * stack.unit()),
                 Vec3d(stack.origin().x + n.x * stack.cell(), stack.origin().y + n.y * stack.cell(), top));
}

Vec3d ConvolutionField::smoothed_gradient(const Vec3d& p, double width) const
{
    Vec3d g(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d offset(0.0);
        offset[axis] = width;
        g[axis] = (value(p + offset) - value(p - offset)) / (2.0 * width);
    }
    return g.length() >= 1e-3 / sigma_ ? g : towards_nearest_interface(p);
}

Vec3d ConvolutionField::towards_nearest_interface(const Vec3d& p) const
{
    // A sheet as thin as the kernel: look along the column for the nearest side of matter.
    const MaterialStack& stack = ground_.stack();
    const double z = (p.z - stack.origin().z) / stack.unit();
    const int i = static_cast<int>(std::floor(confined((p.x - stack.origin().x) / stack.cell(), 0.0, stack.size().x)));
    const int j = static_cast<int>(std::floor(confined((p.y - stack.origin().y) / stack.cell(), 0.0, stack.size().y)));
    double nearest = kInfinity, side = 1.0;
    ground_.for_each_run(i, j, [&](Run run) {
        for (const auto& [height, normal] : {std::pair{run.bottom, -1.0}, std::pair{run.top, 1.0}}) {
            if (std::abs(height - z) < nearest) {
                nearest = std::abs(height - z);
                side = normal;
            }
        }
    });
    return Vec3d(0.0, 0.0, side / sigma_);
}

}  // namespace hoodoo
