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
    double outside = 0.0;   ///< share of samples off the chart or in cells where the density is 0
    /// One chance in 10^8: a hundred such tests stay under one false alarm in a million runs.
    bool holds() const { return p_value > 1e-8 && std::abs(integral - 1.0) < 2e-3 && outside == 0.0; }
};

/// Samples counted in `rows` x `columns` equal cells of a chart, to be held against densities.
class DirectionCounts
{
public:
    /// `sample(random engine) -> direction`.
    template <class Sample>
    DirectionCounts(const Chart& chart, Sample&& sample, int rows, int columns, int count, std::uint64_t seed)
        : chart_(chart), rows_(rows), columns_(columns), count_(count), found_(static_cast<std::size_t>(rows) * columns)
    {
        std::mt19937_64 random(seed);
        for (int k = 0; k < count; ++k) {
            const Vec2d at = chart.place(sample(random));
            const int i = static_cast<int>(at.x * rows), j = std::min(static_cast<int>(at.y * columns), columns - 1);
            if (at.x >= 0.0 && i < rows) {
                found_[static_cast<std::size_t>(i) * columns + j] += 1.0;
            } else {
                outside_ += 1.0 / count;
            }
        }
    }

    /// `density(direction)`, integrated over each cell at `fine` x `fine` midpoints.
    template <class Density>
    DensityVerdict against(Density&& density, int fine) const
    {
        DensityVerdict verdict;
        verdict.outside = outside_;
        std::vector<double> expected(found_.size());
        const double area = 1.0 / (static_cast<double>(rows_) * fine * columns_ * fine);
        for (int i = 0; i < rows_ * fine; ++i) {
            for (int j = 0; j < columns_ * fine; ++j) {
                const double a = (i + 0.5) / (rows_ * fine), b = (j + 0.5) / (columns_ * fine);
                const double mass = density(chart_.direction(a, b)) * chart_.solid_angle(a, b) * area;
                expected[static_cast<std::size_t>(i / fine) * columns_ + j / fine] += mass;
                verdict.integral += mass;
            }
        }

        // Cells that expect few samples are pooled; one that expects none must have none.
        double statistic = 0.0, pooled_expected = 0.0, pooled_found = 0.0;
        int cells = 0;
        const auto add = [&](double e, double f) { statistic += (f - e) * (f - e) / e, ++cells; };
        for (std::size_t c = 0; c < expected.size(); ++c) {
            const double e = expected[c] / verdict.integral * count_;
            if (e == 0.0) {
                verdict.outside += found_[c] / count_;
            } else if (e >= 25.0) {
                add(e, found_[c]);
            } else {
                pooled_expected += e, pooled_found += found_[c];
            }
        }
        if (pooled_expected > 5.0) add(pooled_expected, pooled_found);
        verdict.p_value = boost::math::cdf(boost::math::complement(boost::math::chi_squared(std::max(1, cells - 1)), statistic));
        return verdict;
    }

private:
    const Chart& chart_;
    int rows_, columns_, count_;
    std::vector<double> found_;
    double outside_ = 0.0;
};

inline double uniform(std::mt19937_64& random)
{
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace hoodoo::testing
