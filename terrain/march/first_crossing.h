// The first change of sign of a function of one variable whose slope or curvature is bounded: certified, or as the paper has it.
#pragma once

#include "terrain/math/vec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hoodoo
{

/// What is proved of a function over a piece of a ray, per metre.
struct PieceBound {
    double slope = kInfinity;      ///< Lipschitz constant
    double curvature = kInfinity;  ///< Lipschitz constant of its derivative
};

/// The stretch (a, b) to search, with the values at its ends.
struct Stretch {
    double a, fa, b, fb;
};

/// Whether the function certainly has no zero between two points of one sign. First order: |fa| + |fb| > slope (b - a). Second order: a parabola of
/// the curvature K that touches zero between needs sqrt(2|fa|/K) + sqrt(2|fb|/K) <= b - a.
bool keeps_sign(const Stretch& s, const PieceBound& bound);

/// Whether it certainly rises or falls all the way: the chord's slope exceeds what curvature can undo.
bool is_monotone(const Stretch& s, const PieceBound& bound);

constexpr int kMostEvaluations = 200000;  ///< of one search: a ray that lies in the surface ends there
/// Stretches are halved down to this share of their length in the beginning.
constexpr double kShortest = 0x1p-40;

/// What is looked for.
struct CrossingQuery {
    bool entering = false;  ///< only from f >= 0 to f < 0, else either way
    bool any = false;       ///< whether there is a crossing is all that is asked: t is then some place of a stretch that has one
    double flat = 0.0;
    double accuracy = 0.0;
};

/// The first t in the stretch at which f changes its sign. True if there is one.
/// Certified: no change of sign is missed except where |f| < `flat` all the way through it (a graze that shallow may be either), and the answer is
/// within `accuracy` of the change. Adds the evaluations.
/// f(t) is called with t inside the stretch; closer(a, b) gives the bounds of a piece of it, which is asked when four halvings did not decide.
template <class F, class Closer>
bool first_crossing(const F& f, const Closer& closer, const Stretch& whole, const CrossingQuery& query, const PieceBound& given, double& t,
                    std::uint32_t& evaluations)
{
    const auto [entering, any, flat, accuracy] = query;
    // A stack of stretches yet to search, the nearest on top: halving needs one entry a level.
    struct Entry {
        Stretch s;
        PieceBound bound;
        int halvings;
    };
    Entry stack[64];
    int top = 0;
    stack[top++] = {whole, given, 0};
    int left = kMostEvaluations;
    const double shortest = (whole.b - whole.a) * kShortest;
    while (top > 0) {
        Entry entry = stack[--top];
        Stretch& s = entry.s;
        PieceBound& bound = entry.bound;
        if (entry.halvings == 4 && left > 0) {
            const PieceBound near = closer(s.a, s.b);
            bound = {std::min(bound.slope, near.slope), std::min(bound.curvature, near.curvature)};
            entry.halvings = 0;
            evaluations += 4;
            left -= 4;
        }
        const bool changes = (s.fa < 0.0) != (s.fb < 0.0);
        if (!changes && keeps_sign(s, bound)) continue;
        const double width = s.b - s.a;
        const bool monotone = changes && is_monotone(s, bound);
        if (any && changes && (!entering || s.fa >= 0.0)) {
            t = 0.5 * (s.a + s.b);
            return true;
        }
        if (monotone || width <= accuracy || width <= shortest || left <= 0) {
            if (!changes || (entering && s.fa < 0.0)) continue;
            // One change is left: shrink the bracket by the Illinois rule, which keeps the ends on their sides.
            int side = 0;
            for (int step = 0; step < 60 && s.b - s.a > accuracy; ++step) {
                double m = step % 4 == 3 ? 0.5 * (s.a + s.b) : (s.a * s.fb - s.b * s.fa) / (s.fb - s.fa);
                if (!(m > s.a && m < s.b)) m = 0.5 * (s.a + s.b);
                // Step over the root by a little, so that the bracket closes from both sides.
                m = m - s.a < s.b - m ? std::min(m + 0.25 * accuracy, s.b) : std::max(m - 0.25 * accuracy, s.a);
                const double fm = f(m);
                ++evaluations;
                if ((fm < 0.0) == (s.fa < 0.0)) {
                    s.a = m, s.fa = fm;
                    if (side == -1) s.fb *= 0.5;
                    side = -1;
                } else {
                    s.b = m, s.fb = fm;
                    if (side == 1) s.fa *= 0.5;
                    side = 1;
                }
            }
            t = 0.5 * (s.a + s.b);
            return true;
        }
        // Everywhere within `flat` of zero on this stretch: nothing to be certain of.
        if (!changes &&
            std::max(std::abs(s.fa), std::abs(s.fb)) + std::min(0.5 * bound.slope * width, 0.125 * bound.curvature * width * width) <= flat)
            continue;
        if (!changes && (width <= shortest || left <= 0)) continue;
        const double m = 0.5 * (s.a + s.b), fm = f(m);
        ++evaluations;
        --left;
        stack[top++] = {{m, fm, s.b, s.fb}, bound, entry.halvings + 1};
        stack[top++] = {{s.a, s.fa, m, fm}, bound, entry.halvings + 1};
    }
    return false;
}

}  // namespace hoodoo
