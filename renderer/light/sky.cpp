// The clear sky as a table over elevation and azimuth off the sun: computed once, looked up bilinearly, sampled by its luminance.
//
// Rows lie at elevations pi/2 v^2, so that the horizon, where the sky changes fastest, has rows of 0.02 degrees and the zenith of 3. The sky is
// symmetric about the sun's vertical plane: half of it is stored. Above and below the horizon are two tables, so that the ground does not shine into
// the sky. A sample chooses a cell by luminance times solid angle, then a place in it evenly in sine and azimuth: the density is constant on a cell,
// the radiance bilinear, so weights vary a little and stay exact.

#include "renderer/light/sky.h"

#include "terrain/math/parallel.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

double row_sine(double v)
{
    return std::sin(0.5 * kPi * v * v);
}

/// v of an elevation's sine in [0, 1].
double row_of(double sine)
{
    return std::sqrt(std::asin(std::clamp(sine, 0.0, 1.0)) * (2.0 / kPi));
}

}  // namespace

SkyTable::SkyTable(const AtmosphereParameters& parameters, const Vec3d& sun, const ToRendering& to_rendering) : sun_(sun)
{
    const double horizontal = std::hypot(sun.x, sun.y);
    north_ = horizontal > 0.0 ? Vec3d(sun.x / horizontal, sun.y / horizontal, 0.0) : Vec3d(0.0, 1.0, 0.0);
    east_ = Vec3d(north_.y, -north_.x, 0.0);
    tabulate(parameters, to_rendering);
    make_distribution();
}

void SkyTable::tabulate(const AtmosphereParameters& parameters, const ToRendering& to_rendering)
{
    const Atmosphere air(parameters, sun_.z);
    sun_irradiance_ = to_rendering(to_acescg(air.sun_irradiance()));
    upper_.resize(kUpper * kColumns);
    lower_.resize(kLower * kColumns);
    const auto fill = [&](std::vector<Vec3f>& table, int rows, double side) {
        parallel_items(rows, [&](int i) {
            const double sine = side * row_sine((i + 0.5) / rows), cosine = std::sqrt(1.0 - sine * sine);
            for (int j = 0; j < kColumns; ++j) {
                const double azimuth = kPi * (j + 0.5) / kColumns;
                const Vec3d color = to_acescg(air.radiance(Vec3d(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine)));
                table[i * kColumns + j] = to_rendering(color);
            }
        });
    };
    fill(upper_, kUpper, 1.0);
    fill(lower_, kLower, -1.0);
}

void SkyTable::make_distribution()
{
    cumulative_.resize(upper_.size() + 1);
    for (int i = 0; i < kUpper; ++i) {
        const double solid_angle = row_sine((i + 1.0) / kUpper) - row_sine(static_cast<double>(i) / kUpper);
        for (int j = 0; j < kColumns; ++j) {
            const std::size_t c = static_cast<std::size_t>(i) * kColumns + j;
            // The mean of the channels stands for luminance: it is positive in every rendering space in which the sky is.
            const Vec3f& l = upper_[c];
            cumulative_[c + 1] = cumulative_[c] + solid_angle * std::max(0.0, static_cast<double>(l.x + l.y + l.z));
        }
    }
    if (!(cumulative_.back() > 0.0))  // a black sky: evenly
        for (std::size_t c = 0; c < cumulative_.size(); ++c) cumulative_[c] = static_cast<double>(c);
    for (double& c : cumulative_) c /= cumulative_.back();
}

Vec3f SkyTable::radiance(const Vec3d& w) const
{
    const std::vector<Vec3f>& table = w.z >= 0.0 ? upper_ : lower_;
    const int rows = w.z >= 0.0 ? kUpper : kLower;
    const double azimuth = std::abs(std::atan2(w.dot(east_), w.dot(north_)));
    const double y = std::clamp(row_of(std::abs(w.z)) * rows - 0.5, 0.0, rows - 1.0),
                 x = std::clamp(azimuth / kPi * kColumns - 0.5, 0.0, kColumns - 1.0);
    const int i = std::min(static_cast<int>(y), rows - 2), j = std::min(static_cast<int>(x), kColumns - 2);
    const float fy = static_cast<float>(y - i), fx = static_cast<float>(x - j);
    const Vec3f* at = &table[static_cast<std::size_t>(i) * kColumns + j];
    return (at[0] * (1.0f - fx) + at[1] * fx) * (1.0f - fy) + (at[kColumns] * (1.0f - fx) + at[kColumns + 1] * fx) * fy;
}

int SkyTable::cell(const Vec3d& w) const
{
    const double azimuth = std::abs(std::atan2(w.dot(east_), w.dot(north_)));
    const int i = std::min(static_cast<int>(row_of(w.z) * kUpper), kUpper - 1),
              j = std::min(static_cast<int>(azimuth / kPi * kColumns), kColumns - 1);
    return i * kColumns + j;
}

double SkyTable::pdf(const Vec3d& w) const
{
    if (!(w.z > 0.0)) return 0.0;
    const int c = cell(w), i = c / kColumns;
    const double solid_angle =
        (row_sine((i + 1.0) / kUpper) - row_sine(static_cast<double>(i) / kUpper)) * 2.0 * kPi / kColumns;  // both sides of the sun
    return (cumulative_[c + 1] - cumulative_[c]) / solid_angle;
}

Vec3d SkyTable::sample(const Vec2d& u) const
{
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u.x);
    const int c = static_cast<int>(above - cumulative_.begin()) - 1, i = c / kColumns, j = c % kColumns;
    const double along = std::clamp((u.x - cumulative_[c]) / (cumulative_[c + 1] - cumulative_[c]), 0.0, 1.0);
    const double low = row_sine(static_cast<double>(i) / kUpper), high = row_sine((i + 1.0) / kUpper);

    // One number for the side of the sun and the azimuth, the rest of the other for the elevation.
    const double side = u.y < 0.5 ? 1.0 : -1.0, across = u.y < 0.5 ? 2.0 * u.y : 2.0 * u.y - 1.0;
    const double sine = low + (high - low) * along, cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine)), azimuth = kPi * (j + across) / kColumns;
    return north_ * (cosine * std::cos(azimuth)) + east_ * (side * cosine * std::sin(azimuth)) + Vec3d(0.0, 0.0, sine);
}

}  // namespace hoodoo
