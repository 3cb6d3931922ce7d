// Filter importance sampling (Ernst2006): the offset of a camera ray is drawn with the filter as density, so that all weights are one.
//
// The filters are products of two equal 1-D functions; each is tabulated as a density that is constant on 1024 cells and inverted exactly:
//     box 1;   Gaussian exp(-x^2 / (2 s^2)), s = width / 6, so that 3 pixels give s = 0.5;   Blackman-Harris: four cosines (Harris1978).
// Filters with negative lobes would need signed weights and are left out.

#include "renderer/transport/filter.h"

#include "terrain/error.h"

#include <algorithm>
#include <cmath>

namespace hoodoo {
namespace {

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
    throw Error(ErrorKind::scene, Problem{{}, "unknown pixel filter", "blackman-harris, gaussian or box", "\"" + kind + "\"", nearest_name(kind, kinds)});
}

Filter::Filter(const std::string& kind, double width) : width_(width == 0.0 ? default_width(kind) : width)
{
    default_width(kind);
    if (!(width_ > 0.0) || !std::isfinite(width_))
        throw Error(ErrorKind::scene, Problem{{}, "the width of the pixel filter is out of range", "a positive number of pixels", std::to_string(width), {}});
    cumulative_.resize(kCells + 1);
    for (std::size_t i = 0; i < kCells; ++i)
        cumulative_[i + 1] = cumulative_[i] + shape(kind, (static_cast<double>(i) + 0.5) / kCells - 0.5);
    for (double& c : cumulative_) c /= cumulative_.back();
}

double Filter::offset(double u) const
{
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
    const double hi = *above, lo = *(above - 1);
    const double cell = static_cast<double>(above - cumulative_.begin() - 1) + std::clamp((u - lo) / (hi - lo), 0.0, 1.0);
    return width_ * (cell / kCells - 0.5);
}

double Filter::density(double x) const
{
    const double cell = (x / width_ + 0.5) * kCells;
    if (!(cell >= 0.0 && cell < static_cast<double>(kCells))) return 0.0;
    const auto i = static_cast<std::size_t>(cell);
    return (cumulative_[i + 1] - cumulative_[i]) * kCells / width_;
}

}  // namespace hoodoo
