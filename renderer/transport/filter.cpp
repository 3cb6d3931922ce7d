// Filter importance sampling (Ernst2006): the offset of a camera ray is drawn with the filter as density, so that all weights are one.
//
// The filters are products of two equal 1-D functions; each is tabulated by 1024 cells of equal mass on which the density is constant:
//     box 1;   Gaussian exp(-x^2 / (2 s^2)), s = width / 6, so that 3 pixels give s = 0.5;   Blackman-Harris: four cosines (Harris1978).
// Filters with negative lobes would need signed weights and are left out.

#include "renderer/transport/filter.h"

#include "terrain/error.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr std::size_t kCells = 1024;
constexpr double kPi = 3.14159265358979323846;

/// Unnormalised; `x` in [-1/2, 1/2] is a share of the width.
double shape(const std::string& kind, double x)
{
    if (kind == "gaussian") return std::exp(-18.0 * x * x);
    if (kind == "blackman-harris") {
        const double a = 2.0 * kPi * x;
        return 0.35875 + 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) + 0.01168 * std::cos(3.0 * a);
    }
    return 1.0;
}

}  // namespace

double Filter::default_width(const std::string& kind)
{
    if (kind == "blackman-harris") return 3.3;
    if (kind == "gaussian") return 3.0;
    if (kind == "box") return 1.0;
    const std::vector<std::string> kinds{"blackman-harris", "gaussian", "box"};
    throw Error(ErrorKind::scene,
                Problem{{}, "unknown pixel filter", "blackman-harris, gaussian or box", "\"" + kind + "\"", nearest_name(kind, kinds)});
}

Filter::Filter(const std::string& kind, double width) : width_(width == 0.0 ? default_width(kind) : width)
{
    default_width(kind);
    if (!(width_ > 0.0) || !std::isfinite(width_))
        throw Error(ErrorKind::scene,
                    Problem{{}, "the width of the pixel filter is out of range", "a positive number of pixels", std::to_string(width), {}});

    // Cumulative sums over fine steps, then the places where they pass each share.
    constexpr std::size_t steps = 16 * kCells;
    std::vector<double> cumulative(steps + 1, 0.0);
    for (std::size_t i = 0; i < steps; ++i) cumulative[i + 1] = cumulative[i] + shape(kind, (static_cast<double>(i) + 0.5) / steps - 0.5);
    quantiles_.resize(kCells + 1);
    for (std::size_t i = 0, step = 0; i <= kCells; ++i) {
        const double target = cumulative.back() * static_cast<double>(i) / kCells;
        while (step + 1 < steps && cumulative[step + 1] < target) ++step;
        const double share = std::clamp((target - cumulative[step]) / (cumulative[step + 1] - cumulative[step]), 0.0, 1.0);
        quantiles_[i] = width_ * ((static_cast<double>(step) + share) / steps - 0.5);
    }
}

double Filter::offset(double u) const
{
    const double x = u * kCells;
    const std::size_t cell = std::min(static_cast<std::size_t>(x), kCells - 1);
    return quantiles_[cell] + (quantiles_[cell + 1] - quantiles_[cell]) * (x - static_cast<double>(cell));
}

double Filter::density(double x) const
{
    if (!(x >= quantiles_.front() && x < quantiles_.back())) return 0.0;
    const auto above = std::upper_bound(quantiles_.begin(), quantiles_.end(), x);
    return 1.0 / (kCells * (*above - *(above - 1)));
}

}  // namespace hoodoo
