// A closed interval of reals: what an implicit function answers about a whole box.
#pragma once

#include <algorithm>

namespace hoodoo
{

/// lo <= hi. Encloses every value; how tight it is, each producer states.
struct Interval {
    double lo = 0.0;
    double hi = 0.0;

    bool contains(double x) const { return lo <= x && x <= hi; }
    Interval operator+(const Interval& o) const { return {lo + o.lo, hi + o.hi}; }
    Interval scaled(double k) const { return k >= 0.0 ? Interval{k * lo, k * hi} : Interval{k * hi, k * lo}; }
    static Interval hull(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
};

}  // namespace hoodoo
