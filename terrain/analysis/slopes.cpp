// Derivatives of a height grid from nine samples (Zevenbergen1987): with z1 to z9 row by row from the north-west and L the cell,
//   D = ((z4 + z6) / 2 - z5) / L^2    E = ((z2 + z8) / 2 - z5) / L^2    F = (-z1 + z3 + z7 - z9) / (4 L^2)    G = (z6 - z4) / 2L    H = (z2 - z8) /
//   2L plan = 2 (D H^2 + E G^2 - F G H) / (G^2 + H^2)        profile = -2 (D G^2 + E H^2 + F G H) / (G^2 + H^2)
// The two have opposite signs for the same bend, as their authors have them; the geometric curvatures are given beside them (slopes.h says which).
// Deviation: beyond the rim heights are continued as straight lines, so that every cell has an answer. Missing: cells of unequal sides.
#include "terrain/analysis/slopes.h"

#include "terrain/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

constexpr double kPi = 3.141592653589793;

/// The height of a neighbour, continued over the rim.
double beside(const Elevation& e, int column, int row)
{
    const int c = std::clamp(column, 0, e.columns - 1), r = std::clamp(row, 0, e.rows - 1);
    double z = e.at(c, r);
    if (c != column && e.columns > 1) z += e.at(c, r) - e.at(c + (c - column), r);
    if (r != row && e.rows > 1) z += e.at(c, r) - e.at(c, r + (r - row));
    return z;
}

template <class Value, class F>
std::vector<Value> each(const Elevation& elevation, const F& f)
{
    check_elevation(elevation);
    std::vector<Value> out(elevation.z.size());
    tbb::parallel_for(0, elevation.rows, [&](int row) {
        for (int column = 0; column < elevation.columns; ++column) out[elevation.index(column, row)] = f(quadric(elevation, column, row));
    });
    return out;
}

}  // namespace

void check_elevation(const Elevation& e)
{
    const auto refuse = [](std::string what, std::string expected, std::string got) {
        throw Error(ErrorKind::scene, Problem{{}, std::move(what), std::move(expected), std::move(got), {}});
    };
    if (e.columns < 1 || e.rows < 1 || e.z.size() != static_cast<std::size_t>(e.columns) * static_cast<std::size_t>(e.rows))
        refuse("the size of the elevation grid", "columns x rows samples", fmt::format("{} x {} and {} samples", e.columns, e.rows, e.z.size()));
    if (!(e.cell > 0.0) || !std::isfinite(e.cell)) refuse("the cell of the elevation grid", "a length above 0", fmt::format("{}", e.cell));
    std::size_t bad = 0, first = 0;
    for (std::size_t k = 0; k < e.z.size(); ++k)
        if (!std::isfinite(e.z[k]) && bad++ == 0) first = k;
    if (bad > 0)
        refuse("samples of the elevation grid are no numbers", "finite heights",
               fmt::format("{} that are not, the first at column {}, row {}", bad, first % static_cast<std::size_t>(e.columns),
                           first / static_cast<std::size_t>(e.columns)));
}

Quadric quadric(const Elevation& e, int column, int row)
{
    const auto z = [&](int dx, int dy) { return beside(e, column + dx, row - dy); };
    const double centre = e.at(column, row), l = e.cell;
    return {(0.5 * (z(-1, 0) + z(1, 0)) - centre) / (l * l), (0.5 * (z(0, 1) + z(0, -1)) - centre) / (l * l),
            (-z(-1, 1) + z(1, 1) + z(-1, -1) - z(1, -1)) / (4.0 * l * l), (z(1, 0) - z(-1, 0)) / (2.0 * l), (z(0, 1) - z(0, -1)) / (2.0 * l)};
}

Curvature curvature(const Quadric& q)
{
    const double steep2 = q.g * q.g + q.h * q.h;
    if (!(steep2 > 0.0)) return {};
    Curvature c;
    c.plan = 2.0 * (q.d * q.h * q.h + q.e * q.g * q.g - q.f * q.g * q.h) / steep2;
    c.profile = -2.0 * (q.d * q.g * q.g + q.e * q.h * q.h + q.f * q.g * q.h) / steep2;
    c.contour = -c.plan / std::sqrt(steep2);
    c.normal = c.profile / std::pow(1.0 + steep2, 1.5);
    c.tangential = -c.plan / std::sqrt(1.0 + steep2);
    return c;
}

std::vector<double> slope(const Elevation& elevation)
{
    return each<double>(elevation, [](const Quadric& q) { return std::atan(std::hypot(q.g, q.h)); });
}

std::vector<double> aspect(const Elevation& elevation)
{
    return each<double>(elevation, [](const Quadric& q) {
        if (q.g == 0.0 && q.h == 0.0) return -1.0;
        const double a = std::atan2(-q.g, -q.h);
        return a < 0.0 ? a + 2.0 * kPi : a + 0.0;  // no -0
    });
}

std::vector<Curvature> curvatures(const Elevation& elevation)
{
    return each<Curvature>(elevation, curvature);
}

std::vector<double> hillshade(const Elevation& elevation, double azimuth, double altitude, double exaggeration)
{
    const double x = std::cos(altitude) * std::sin(azimuth), y = std::cos(altitude) * std::cos(azimuth), z = std::sin(altitude);
    return each<double>(elevation, [&](const Quadric& q) {
        const double g = exaggeration * q.g, h = exaggeration * q.h;
        return std::max(0.0, (-g * x - h * y + z) / std::sqrt(1.0 + g * g + h * h));
    });
}

}  // namespace hoodoo
