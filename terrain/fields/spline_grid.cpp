// In cell (i, j) the spline is a mean of the 16 coefficients i - 1 .. i + 2, j - 1 .. j + 2 with weights that are not negative and sum to 1. A
// derivative is the same of their first differences, a second derivative of their second ones: hulls of these enclose it.
#include "terrain/fields/spline_grid.h"

#include "terrain/error.h"

#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kMostCells = 16;         // along a side: beyond, the bounds of the whole grid answer
constexpr double kRounding = 0x1p-46;  // of sums of 16 products, with room

std::array<double, 4> basis(double t)
{
    const double r = 1.0 - t;
    return {r * r * r / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0, t * t * t / 6.0};
}

std::array<double, 4> basis_slope(double t)
{
    const double r = 1.0 - t;
    return {-0.5 * r * r, -2.0 * t + 1.5 * t * t, 2.0 * r - 1.5 * r * r, 0.5 * t * t};
}

}  // namespace

SplineGrid::SplineGrid(const Vec2d& origin, double cell, int columns, int rows, std::vector<float> coefficients)
    : origin_(origin), cell_(cell), columns_(columns), rows_(rows), coefficients_(std::move(coefficients))
{
    if (columns < 4 || rows < 4 || coefficients_.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows))
        throw Error(ErrorKind::internal, "a spline needs 4 x 4 coefficients");
    domain_ = {origin + Vec2d(cell), origin + Vec2d((columns - 2) * cell, (rows - 2) * cell)};
    whole_ = enclose(1, columns - 3, 1, rows - 3);
}

SplineGrid::Place SplineGrid::place(const Vec2d& p) const
{
    const double u = std::clamp((p.x - origin_.x) / cell_, 1.0, columns_ - 2.0), v = std::clamp((p.y - origin_.y) / cell_, 1.0, rows_ - 2.0);
    const int i = std::min(static_cast<int>(u), columns_ - 3), j = std::min(static_cast<int>(v), rows_ - 3);
    return {i, j, u - i, v - j};
}

double SplineGrid::height(const Vec2d& p) const
{
    const Place at_p = place(p);
    const std::array<double, 4> bx = basis(at_p.s), by = basis(at_p.t);
    double sum = 0.0;
    for (int b = 0; b < 4; ++b) {
        double row = 0.0;
        for (int a = 0; a < 4; ++a) row += bx[static_cast<std::size_t>(a)] * at(at_p.i + a - 1, at_p.j + b - 1);
        sum += by[static_cast<std::size_t>(b)] * row;
    }
    return sum;
}

Vec2d SplineGrid::gradient(const Vec2d& p) const
{
    const Place at_p = place(p);
    const std::array<double, 4> bx = basis(at_p.s), by = basis(at_p.t), dx = basis_slope(at_p.s), dy = basis_slope(at_p.t);
    Vec2d sum(0.0);
    for (int b = 0; b < 4; ++b) {
        double value = 0.0, slope = 0.0;
        for (int a = 0; a < 4; ++a) {
            const double c = at(at_p.i + a - 1, at_p.j + b - 1);
            value += bx[static_cast<std::size_t>(a)] * c;
            slope += dx[static_cast<std::size_t>(a)] * c;
        }
        sum.x += by[static_cast<std::size_t>(b)] * slope;
        sum.y += dy[static_cast<std::size_t>(b)] * value;
    }
    // Beyond the domain it is level across its edge.
    if (p.x < domain_.min.x || p.x > domain_.max.x) sum.x = 0.0;
    if (p.y < domain_.min.y || p.y > domain_.max.y) sum.y = 0.0;
    return sum / cell_;
}

HeightBounds SplineGrid::bounds(const Box2d& area) const
{
    // A place may round across a cell's border; there the neighbours agree in all that is asked.
    const Place lo = place(area.min), hi = place(area.max);
    HeightBounds known = hi.i - lo.i >= kMostCells || hi.j - lo.j >= kMostCells ? whole_ : enclose(lo.i, hi.i, lo.j, hi.j);
    const bool across_x = area.min.x < domain_.min.x || area.max.x > domain_.max.x,
               across_y = area.min.y < domain_.min.y || area.max.y > domain_.max.y;
    if (across_x) known.gradient[0] = Interval::hull(known.gradient[0], {0.0, 0.0});
    if (across_y) known.gradient[1] = Interval::hull(known.gradient[1], {0.0, 0.0});
    if (across_x || across_y) known.curvature = kInfinity;
    return known;
}

HeightBounds SplineGrid::enclose(int i0, int i1, int j0, int j1) const
{
    const Interval none{kInfinity, -kInfinity};
    Interval value = none, x = none, y = none, xx = none, xy = none, yy = none;
    const auto take = [](Interval& hull, double v) { hull.lo = std::min(hull.lo, v), hull.hi = std::max(hull.hi, v); };
    for (int j = j0 - 1; j <= j1 + 2; ++j) {
        for (int i = i0 - 1; i <= i1 + 2; ++i) {
            const double c = at(i, j);
            take(value, c);
            const bool right = i < i1 + 2, up = j < j1 + 2;
            if (right) take(x, at(i + 1, j) - c);
            if (up) take(y, at(i, j + 1) - c);
            if (right && up) take(xy, at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + c);
            if (i < i1 + 1) take(xx, at(i + 2, j) - 2.0 * at(i + 1, j) + c);
            if (j < j1 + 1) take(yy, at(i, j + 2) - 2.0 * at(i, j + 1) + c);
        }
    }
    const double room = kRounding * value.magnitude(), per = 1.0 / cell_;
    const auto widened = [](const Interval& a, double by) { return Interval{a.lo - by, a.hi + by}; };
    HeightBounds known;
    known.value = widened(value, room);
    known.gradient = {widened(x.scaled(per), room * per), widened(y.scaled(per), room * per)};
    known.slope = std::hypot(known.gradient[0].magnitude(), known.gradient[1].magnitude());
    // The norm of the second derivative is at most that of all its elements.
    const double bend = std::hypot(xx.magnitude(), yy.magnitude(), std::sqrt(2.0) * xy.magnitude());
    known.curvature = (bend + room) * per * per;
    return known;
}

}  // namespace hoodoo
