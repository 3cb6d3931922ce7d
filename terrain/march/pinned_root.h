// The root of a function that is known to rise, or to fall, all the way: few evaluations, and an interval that holds it at every step.
#pragma once

#include "terrain/march/first_crossing_batched.h"
#include "terrain/math/interval.h"

namespace hoodoo
{

/// What is known of f over (from, to): its derivative lies in `rise`, which does not hold zero, its second derivative is at most `curvature`, and the
/// root is near `guess`, the slope there about `slope`.
struct PinnedRoot {
    double from, to;
    Interval rise;
    double curvature = kInfinity;
    double guess = 0.0, slope = 1.0;

    /// f(s) = value puts the root (interval Newton) into s - value / rise: narrows (from, to) to that.
    void narrow(double s, double value)
    {
        const double a = -value / rise.lo, b = -value / rise.hi;
        from = std::max(from, s + std::min(a, b));
        to = std::min(to, s + std::max(a, b));
    }
};

/// Whether f has its root in (from, to), or outside by less than `accuracy`; t is within `accuracy` of it. With `any` it is enough that there is one:
/// then t may lie anywhere. f(t, values) takes `Batch` places. Adds the evaluations.
template <int Batch, class F>
bool pinned_root(const F& f, PinnedRoot root, bool any, double accuracy, double& t, std::uint32_t& evaluations)
{
    const double whole_from = root.from, whole_to = root.to;
    double spread = 0.5 * (root.to - root.from), guess = root.guess;
    // The last two places asked, nearest to the root from either side where both are known.
    Stretch known{kInfinity, 0.0, kInfinity, 0.0};
    for (int round = 0; round < 80; ++round) {
        if (!(guess > root.from && guess < root.to)) guess = 0.5 * (root.from + root.to);
        double at[Batch], value[Batch];
        if constexpr (Batch == 1) {
            at[0] = guess;
        } else {
            // Around the guess, each pair four times nearer than the last: guesses are far better than what is proved of them.
            double near = spread;
            for (int k = 0; k < Batch / 2; ++k, near = std::max(0.25 * near, 0.4 * accuracy)) {
                at[k] = std::max(root.from, guess - near);
                at[Batch - 1 - k] = std::min(root.to, guess + near);
            }
        }
        f(at, value);
        evaluations += Batch;
        const bool falls = root.rise.hi < 0.0;
        for (int k = 0; k < Batch; ++k) {
            root.narrow(at[k], value[k]);
            // Before the root, or behind it?
            if ((value[k] < 0.0) != falls)
                known.a = at[k], known.fa = value[k];
            else if (!(known.b <= at[k]))
                known.b = at[k], known.fb = value[k];
        }
        const bool both = std::isfinite(known.a) && std::isfinite(known.b);
        if (any && both) return true;
        if (root.from > root.to + accuracy) return false;
        double width = root.to - root.from;
        if (both && known.b > known.a) {
            // The chord's root is off by no more than the curve leaves its chord, over the least slope.
            guess = known.a + (known.b - known.a) * (known.fa / (known.fa - known.fb));
            const double least = std::min(std::abs(root.rise.lo), std::abs(root.rise.hi)), w = known.b - known.a;
            const double off = 0.125 * root.curvature * w * w / least;
            if (off < 0.5 * width) {
                root.from = std::max(root.from, guess - off), root.to = std::min(root.to, guess + off);
                width = root.to - root.from;
            }
        } else {
            guess = at[Batch / 2] - value[Batch / 2] / root.slope;
        }
        if (width <= accuracy) {
            t = std::clamp(0.5 * (root.from + root.to), whole_from, whole_to);
            return true;
        }
        // Halving now and then, so that a bad slope cannot keep it from ending.
        if (round % 4 == 3) guess = 0.5 * (root.from + root.to);
        spread = 0.5 * width;
    }
    t = std::clamp(0.5 * (root.from + root.to), whole_from, whole_to);
    return true;
}

}  // namespace hoodoo
