// Whether a sampler follows the density it states: Pearson's test over a chart of directions, and the density's integral.
#pragma once

#include "terrain/math/vec.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace hoodoo::testing
{

/// Directions as the unit square: direction(a, b), its inverse, and the solid angle of a unit of the square.
struct Chart {
    virtual ~Chart() = default;
    virtual Vec3d direction(double a, double b) const = 0;
    virtual Vec2d place(const Vec3d& w) const = 0;  ///< may lie outside the unit square
    virtual double solid_angle(double a, double b) const = 0;
};

/// a = from `axis` backwards in equal solid angles, over the whole sphere (`span` 2) or the part 1 - cosine <= span.
class SphereChart final : public Chart
{
public:
    explicit SphereChart(const Vec3d& axis, double span = 2.0) : axis_(axis), span_(span) { orthonormal_frame(axis_, t_, b_); }
    Vec3d direction(double a, double b) const override
    {
        const double drop = span_ * a, sine = std::sqrt(drop * (2.0 - drop)), angle = 2.0 * pi * b;
        return t_ * (sine * std::cos(angle)) + b_ * (sine * std::sin(angle)) + axis_ * (1.0 - drop);
    }
    Vec2d place(const Vec3d& w) const override
    {
        const double angle = std::atan2(w.dot(b_), w.dot(t_)) / (2.0 * pi);
        return Vec2d(0.5 * (w - axis_).length2() / span_, angle < 0.0 ? angle + 1.0 : angle);
    }
    double solid_angle(double, double) const override { return 2.0 * pi * span_; }

private:
    static constexpr double pi = 3.14159265358979323846;
    Vec3d axis_, t_, b_;
    double span_;
};

struct DensityVerdict {
    double p_value = 0.0;   ///< probability of a statistic this large if the sampler is right
    double integral = 0.0;  ///< of the density over the chart
    double outside = 0.0;   ///< share of samples off the chart or where the density is 0
    /// Eight chances in 10^8: a suite of a hundred such tests stays under a false alarm in a million runs.
    bool holds() const { return p_value > 1e-8 && std::abs(integral - 1.0) < 2e-3 && outside == 0.0; }
};

/// `sample(random engine) -> direction`, `density(direction)`. `rows` x `columns` cells, each integrated at `fine` x `fine` midpoints.
template <class Sample, class Density>
DensityVerdict check_density(const Chart& chart, Sample&& sample, Density&& density, int rows, int columns, int fine, int count, std::uint64_t seed)
{
    DensityVerdict verdict;
    std::vector<double> expected(static_cast<std::size_t>(rows) * columns), found(expected.size());
    for (int i = 0; i < rows * fine; ++i) {
        for (int j = 0; j < columns * fine; ++j) {
            const double a = (i + 0.5) / (rows * fine), b = (j + 0.5) / (columns * fine);
            const double mass = density(chart.direction(a, b)) * chart.solid_angle(a, b) / (static_cast<double>(rows) * fine * columns * fine);
            expected[static_cast<std::size_t>(i / fine) * columns + j / fine] += mass;
            verdict.integral += mass;
        }
    }
    std::mt19937_64 random(seed);
    for (int k = 0; k < count; ++k) {
        const Vec3d w = sample(random);
        const Vec2d at = chart.place(w);
        const int i = static_cast<int>(at.x * rows), j = std::min(static_cast<int>(at.y * columns), columns - 1);
        if (!(at.x >= 0.0) || i >= rows || !(density(w) > 0.0)) {
            verdict.outside += 1.0 / count;
            continue;
        }
        found[static_cast<std::size_t>(i) * columns + j] += 1.0;
    }

    // Cells that expect few samples are pooled.
    double statistic = 0.0, pooled_expected = 0.0, pooled_found = 0.0;
    int cells = 0;
    const auto add = [&](double e, double f) { statistic += (f - e) * (f - e) / e, ++cells; };
    for (std::size_t c = 0; c < expected.size(); ++c) {
        const double e = expected[c] / verdict.integral * count;
        if (e >= 25.0) {
            add(e, found[c]);
        } else {
            pooled_expected += e, pooled_found += found[c];
        }
    }
    if (pooled_expected > 5.0) add(pooled_expected, pooled_found);
    verdict.p_value = boost::math::cdf(boost::math::complement(boost::math::chi_squared(std::max(1, cells - 1)), statistic));
    return verdict;
}

inline double uniform(std::mt19937_64& random)
{
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace hoodoo::testing
