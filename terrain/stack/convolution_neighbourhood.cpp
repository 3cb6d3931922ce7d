// Value, gradient and smoothed gradient of a convolution field in one walk over the columns around a point (Peytavie2009, section 3.3).
//
// The central differences along x and y see the same column overlaps D(z) under shifted weights, those along z the overlaps of a shifted window
// under the same weights: each column is read once, its matter C cumulated at six heights, where separate calls would read it nine times.

#include "terrain/stack/convolution.h"
#include "terrain/stack/window.h"

#include <array>

namespace hoodoo
{
namespace
{

/// Columns along an axis that the fast path keeps weights for; wider kernels call the plain functions.
constexpr int kMostColumns = 40;

/// Weights of the columns along one axis for the kernel at the point and shifted by the half-width to either side.
struct Weights {
    Weights(double centre, double half, double width, int n)
    {
        const Window low = window(centre - width, half, n), middle = window(centre, half, n), high = window(centre + width, half, n);
        first = low.first, count = high.last - low.first + 1;
        left = middle.first - first, right = middle.last - first;
        if (count > kMostColumns) return;
        for (int k = 0; k < count; ++k) {
            const int i = first + k;
            below[k] = std::max(0.0, low.weight(i)), at[k] = std::max(0.0, middle.weight(i)), above[k] = std::max(0.0, high.weight(i));
        }
    }
    int first, count;
    int left, right;  ///< of the columns in which the faces of the kernel at the point lie
    std::array<double, kMostColumns> below, at, above;
};

/// Matter of one column: overlap with the kernel at the point, change of overlap when it moves up (central), one-sided derivative.
struct Column {
    double overlap = 0.0, rise = 0.0;
    int derivative = 0;
};

Column read_column(const Ground& ground, int i, int j, double z, double tall, double width)
{
    Column c;
    const double low = z - tall, high = z + tall;
    ground.for_each_run(i, j, [&](Run run) {
        const double bottom = run.bottom, top = run.top;
        const auto overlap = [&](double from, double to) { return std::max(0.0, std::min(to, top) - std::max(from, bottom)); };
        c.overlap += overlap(low, high);
        c.rise += overlap(low + width, high + width) - overlap(low - width, high - width);
        c.derivative += (bottom <= high && high < top) - (bottom <= low && low < top);
    });
    return c;
}

}  // namespace

ConvolutionField::Neighbourhood ConvolutionField::neighbourhood(const Vec3d& p, double width) const
{
    const MaterialStack& stack = ground_.stack();
    const double s = stack.cell(), unit = stack.unit(), half = sigma_ / s, tall = sigma_ / unit;
    const Weights x((p.x - stack.origin().x) / s, half, width / s, stack.size().x), y((p.y - stack.origin().y) / s, half, width / s, stack.size().y);
    if (x.count > kMostColumns || y.count > kMostColumns) return {value(p), gradient(p), smoothed_gradient(p, width)};

    const double z = (p.z - stack.origin().z) / unit;
    double volume = 0.0;
    Vec3d change(0.0), slope(0.0);
    for (int j = 0; j < y.count; ++j) {
        double row = 0.0, row_change = 0.0, row_rise = 0.0, row_derivative = 0.0, left = 0.0, right = 0.0;
        for (int i = 0; i < x.count; ++i) {
            const Column c = read_column(ground_, x.first + i, y.first + j, z, tall, width / unit);
            row += x.at[i] * c.overlap;
            row_change += (x.above[i] - x.below[i]) * c.overlap;
            row_rise += x.at[i] * c.rise;
            row_derivative += x.at[i] * c.derivative;
            if (i == x.left) left = c.overlap;
            if (i == x.right) right = c.overlap;
        }
        volume += y.at[j] * row;
        change += Vec3d(y.at[j] * row_change, (y.above[j] - y.below[j]) * row, y.at[j] * row_rise);
        slope.x += y.at[j] * (right - left);
        slope.z += y.at[j] * row_derivative;
        if (j == y.left) slope.y -= row;
        if (j == y.right) slope.y += row;
    }
    const double scale = -1.0 / (4.0 * half * half * tall);
    Neighbourhood n;
    n.value = std::clamp(1.0 + volume * scale, -1.0, 1.0);
    n.gradient = Vec3d(slope.x / s, slope.y / s, slope.z / unit) * scale;
    n.smoothed = change * (scale / (2.0 * width));
    if (!(n.smoothed.length() >= 1e-3 / sigma_)) n.smoothed = towards_nearest_interface(p);
    return n;
}

}  // namespace hoodoo
