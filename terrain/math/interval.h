// A closed interval of reals: what an implicit function answers about a whole box.
#pragma once

#include <algorithm>
#include <cmath>

namespace hoodoo
{

/// lo <= hi. Encloses every value; how tight it is, each producer states.
struct Interval {
    double lo = 0.0;
    double hi = 0.0;

    bool contains(double x) const { return lo <= x && x <= hi; }
    Interval operator+(const Interval& o) const { return {lo + o.lo, hi + o.hi}; }
    Interval scaled(double k) const { return k >= 0.0 ? Interval{k * lo, k * hi} : Interval{k * hi, k * lo}; }
    Interval operator-() const { return {-hi, -lo}; }
    Interval operator*(const Interval& o) const
    {
        const auto [least, most] = std::minmax({lo * o.lo, lo * o.hi, hi * o.lo, hi * o.hi});
        return {least, most};
    }
    double magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }  ///< the largest absolute value
    /// What lies in both; lo > hi if nothing does.
    static Interval common(const Interval& a, const Interval& b) { return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)}; }
    static Interval hull(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
};

}  // namespace hoodoo
