// The same search as first_crossing.h for a function that is cheaper to ask for sixteen values at once: stretches are cut into fifteen.
#pragma once

#include "terrain/march/first_crossing.h"

namespace hoodoo
{

/// A function that changes its sign once between the ends of the bracket: shrinks it to `accuracy`. Points are laid around the chord's root, each
/// eight times nearer than the last, so that a bracket shrinks to about eight times the chord's own error.
template <class F>
double close_in(const F& f, Stretch s, double accuracy, std::uint32_t& evaluations)
{
    for (int round = 0; round < 24 && s.b - s.a > accuracy; ++round) {
        const double width = s.b - s.a;
        double root = s.a + width * (s.fa / (s.fa - s.fb));
        if (!(root > s.a && root < s.b) || round % 6 == 5) root = 0.5 * (s.a + s.b);
        double at[16], value[16];
        double step = 0.125 * width;
        for (int k = 0; k < 8; ++k, step *= 0.125) {
            const double near = std::max(step, 0.25 * accuracy);
            at[k] = std::max(s.a, root - near);
            at[15 - k] = std::min(s.b, root + near);
        }
        f(at, value);
        evaluations += 16;
        for (int k = 0; k < 16; ++k) {
            if (!(at[k] > s.a && at[k] < s.b)) continue;
            if ((value[k] < 0.0) == (s.fa < 0.0)) {
                s.a = at[k], s.fa = value[k];
            } else {
                s.b = at[k], s.fb = value[k];
                break;
            }
        }
    }
    return 0.5 * (s.a + s.b);
}

/// The contract of first_crossing(); f(t, values) takes sixteen places.
template <class F, class Closer>
bool first_crossing_batched(const F& f, const Closer& closer, double a, double b, bool entering, const PieceBound& given, double flat,
                            double accuracy, double& t, std::uint32_t& evaluations)
{
    struct Entry {
        Stretch s;
        PieceBound bound;
        int cuts;
    };
    // Fifteen a level; shortest stretches are 15^-11 of the whole.
    Entry stack[15 * 12];
    int top = 0, left = kMostEvaluations;
    const double shortest = (b - a) * kShortest;
    const auto cut = [&](double from, double to, const Stretch* ends, const PieceBound& bound, int cuts) {
        double at[16], value[16];
        for (int k = 0; k < 16; ++k) at[k] = k == 15 ? to : from + (to - from) * (k / 15.0);
        f(at, value);
        if (ends) value[0] = ends->fa, value[15] = ends->fb;
        evaluations += 16;
        left -= 16;
        for (int k = 14; k >= 0; --k) stack[top++] = {{at[k], value[k], at[k + 1], value[k + 1]}, bound, cuts};
    };
    cut(a, b, nullptr, given, 0);
    while (top > 0) {
        Entry entry = stack[--top];
        const Stretch& s = entry.s;
        const bool changes = (s.fa < 0.0) != (s.fb < 0.0);
        const double width = s.b - s.a;
        if (!changes && keeps_sign(s, entry.bound)) continue;
        const bool last = width <= accuracy || width <= shortest || left <= 0 || top + 15 > 15 * 12;
        if (changes && (last || is_monotone(s, entry.bound))) {
            if (entering && s.fa < 0.0) continue;
            t = close_in(f, s, accuracy, evaluations);
            return true;
        }
        if (last) continue;
        if (!changes &&
            std::max(std::abs(s.fa), std::abs(s.fb)) + std::min(0.5 * entry.bound.slope * width, 0.125 * entry.bound.curvature * width * width) <=
                flat)
            continue;
        if (entry.cuts == 1) {
            const PieceBound near = closer(s.a, s.b);
            entry.bound = {std::min(entry.bound.slope, near.slope), std::min(entry.bound.curvature, near.curvature)};
            evaluations += 4;
            left -= 4;
            entry.cuts = 0;
            if (!changes && keeps_sign(s, entry.bound)) continue;
        }
        cut(s.a, s.b, &s, entry.bound, entry.cuts + 1);
    }
    return false;
}

}  // namespace hoodoo
