// The same search as first_crossing.h for a function that is cheaper to ask for a batch of values at once: stretches are cut into one part fewer.
#pragma once

#include "terrain/march/first_crossing.h"

namespace hoodoo
{

/// The zero of the inverse function's interpolant through n points (Neville), a guess: NaN or far off where the function is not monotone there.
inline double inverse_interpolation(const double* at, const double* value, int n)
{
    double p[4];
    for (int i = 0; i < n; ++i) p[i] = at[i];
    for (int k = 1; k < n; ++k)
        for (int i = 0; i + k < n; ++i) p[i] = (value[i + k] * p[i] - value[i] * p[i + 1]) / (value[i + k] - value[i]);
    return p[0];
}

/// A function that changes its sign once between the ends of the bracket: shrinks it to `accuracy`. Points are laid around a guess of the root, each
/// much farther than the last, so that a bracket shrinks to about the guess's own error.
template <int Batch, class F>
double close_in(const F& f, Stretch s, double guess, double accuracy, std::uint32_t& evaluations)
{
    for (int round = 0; round < 24 && s.b - s.a > accuracy; ++round) {
        const bool evenly = !(guess > s.a && guess < s.b) || round % 6 == 5;
        double at[Batch], value[Batch];
        double near = 0.45 * accuracy;
        for (int k = Batch / 2 - 1; k >= 0; --k, near *= 24.0) {
            at[k] = std::max(s.a, guess - near);
            at[Batch - 1 - k] = std::min(s.b, guess + near);
        }
        for (int k = 0; evenly && k < Batch; ++k) at[k] = s.a + (s.b - s.a) * (k + 1) / (Batch + 1);
        f(at, value);
        evaluations += Batch;
        double x[4] = {s.a, s.b}, y[4] = {s.fa, s.fb};
        int known = 2;
        for (int k = 0; k < Batch; ++k) {
            if (!(at[k] > s.a && at[k] < s.b)) continue;
            if ((value[k] < 0.0) == (s.fa < 0.0)) {
                s.a = at[k], s.fa = value[k];
            } else {
                s.b = at[k], s.fb = value[k];
                if (k + 1 < Batch && at[k + 1] > s.b) x[known] = at[k + 1], y[known++] = value[k + 1];
                break;
            }
        }
        x[0] = s.a, y[0] = s.fa, x[1] = s.b, y[1] = s.fb;
        guess = inverse_interpolation(x, y, known);
    }
    return 0.5 * (s.a + s.b);
}

/// The contract of first_crossing(); f(t, values) takes `Batch` places.
template <int Batch, class F, class Closer>
bool first_crossing_batched(const F& f, const Closer& closer, double a, double b, const CrossingQuery& query, const PieceBound& given, double& t,
                            std::uint32_t& evaluations)
{
    struct Entry {
        Stretch s;
        double guess;  ///< of the root, where the ends differ in sign
        PieceBound bound;
        int cuts;
    };
    constexpr int parts = Batch - 1, levels = 16;
    // So many a level; kShortest is parts^-14.
    Entry stack[parts * levels];
    const auto [entering, any, flat, accuracy] = query;
    int top = 0, left = kMostEvaluations;
    const double shortest = (b - a) * kShortest;
    const auto cut = [&](double from, double to, const Stretch* ends, const PieceBound& bound, int cuts) {
        double at[Batch], value[Batch];
        for (int k = 0; k < Batch; ++k) at[k] = k == parts ? to : from + (to - from) * (static_cast<double>(k) / parts);
        f(at, value);
        if (ends) value[0] = ends->fa, value[parts] = ends->fb;
        evaluations += Batch;
        left -= Batch;
        for (int k = parts - 1; k >= 0; --k) {
            const int first = std::clamp(k - 1, 0, Batch - 4);
            const double guess = (value[k] < 0.0) != (value[k + 1] < 0.0) ? inverse_interpolation(at + first, value + first, 4) : 0.0;
            stack[top++] = {{at[k], value[k], at[k + 1], value[k + 1]}, guess, bound, cuts};
        }
    };
    cut(a, b, nullptr, given, 0);
    while (top > 0) {
        Entry entry = stack[--top];
        const Stretch& s = entry.s;
        const bool changes = (s.fa < 0.0) != (s.fb < 0.0);
        const double width = s.b - s.a;
        if (!changes && keeps_sign(s, entry.bound)) continue;
        if (any && changes && (!entering || s.fa >= 0.0)) {
            t = 0.5 * (s.a + s.b);
            return true;
        }
        const bool last = width <= accuracy || width <= shortest || left <= 0 || top + parts > parts * levels;
        if (changes && (last || is_monotone(s, entry.bound))) {
            if (entering && s.fa < 0.0) continue;
            t = close_in<Batch>(f, s, entry.guess, accuracy, evaluations);
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
