// Every breakpoint of a convolution field along a ray, and the exact cubic between them (maths of stacks, A2).
//
// Rounding: the value is a sum of at most some hundred products, so it is off by less than 1e-13; the position of a point adds 2^-52 of its
// coordinates times the slope sqrt(3) / sigma. Margins are chosen far above both.

#include "tests/support/stack_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hoodoo::testing
{
namespace
{

/// Power-basis cubic in u on [0, 1] through the values at 0, 1/3, 2/3, 1.
struct Power {
    double a, b, c, d;  // a + b u + c u^2 + d u^3
    explicit Power(const std::array<double, 4>& f)
        : a(f[0]),
          b((-11.0 * f[0] + 18.0 * f[1] - 9.0 * f[2] + 2.0 * f[3]) / 2.0),
          c(9.0 * (2.0 * f[0] - 5.0 * f[1] + 4.0 * f[2] - f[3]) / 2.0),
          d(9.0 * (-f[0] + 3.0 * f[1] - 3.0 * f[2] + f[3]) / 2.0)
    {
    }
    double operator()(double u) const { return a + u * (b + u * (c + u * d)); }
};

/// Ends of the monotone parts: 0, the roots of the derivative in (0, 1), 1.
std::vector<double> monotone_parts(const Power& p)
{
    std::vector<double> ends{0.0, 1.0};
    const double qa = 3.0 * p.d, qb = 2.0 * p.c, qc = p.b;
    const auto add = [&](double u) {
        if (u > 0.0 && u < 1.0) ends.push_back(u);
    };
    if (qa == 0.0) {
        if (qb != 0.0) add(-qc / qb);
    } else {
        const double discriminant = qb * qb - 4.0 * qa * qc;
        if (discriminant >= 0.0) {
            const double q = -0.5 * (qb + std::copysign(std::sqrt(discriminant), qb));
            add(q / qa);
            if (q != 0.0) add(qc / q);
        }
    }
    std::sort(ends.begin(), ends.end());
    return ends;
}

/// Where a monotone part passes `level`, by bisection.
double passage(const Power& p, double lo, double hi, double level)
{
    const bool rising = p(hi) > p(lo);
    for (int i = 0; i < 60; ++i) {
        const double u = 0.5 * (lo + hi);
        ((p(u) < level) == rising ? lo : hi) = u;
    }
    return 0.5 * (lo + hi);
}

}  // namespace

double StackOracle::value(const Vec3d& p) const
{
    const MaterialStack& stack = ground_.stack();
    const double s = stack.cell(), unit = stack.unit();
    const Vec3d q = p - stack.origin();
    double volume = 0.0;
    for (int j = static_cast<int>(std::floor((q.y - sigma_) / s)); j * s < q.y + sigma_; ++j) {
        const double wy = std::min(q.y + sigma_, (j + 1) * s) - std::max(q.y - sigma_, j * s);
        for (int i = static_cast<int>(std::floor((q.x - sigma_) / s)); i * s < q.x + sigma_; ++i) {
            const double wx = std::min(q.x + sigma_, (i + 1) * s) - std::max(q.x - sigma_, i * s);
            if (wx <= 0.0 || wy <= 0.0) continue;
            ground_.for_each_run(i, j, [&](const Run& run) {
                const double lo = std::max(q.z - sigma_, run.bottom * unit), hi = std::min(q.z + sigma_, run.top * unit);
                if (hi > lo) volume += wx * wy * (hi - lo);
            });
        }
    }
    return 1.0 - volume / (4.0 * sigma_ * sigma_ * sigma_);
}

bool StackOracle::domain_interval(const Ray& ray, double& t0, double& t1) const
{
    const MaterialStack& stack = ground_.stack();
    const bool cut = ground_.border() == Border::cut;
    const double margin = cut ? stack.cell() : 0.0;
    const double top = stack.highest_top() * stack.unit() + sigma_;
    const Vec3d lo(-margin, -margin, (cut ? ground_.floor() * stack.unit() : 0.0) - sigma_);
    const Vec3d hi(stack.size().x * stack.cell() + margin, stack.size().y * stack.cell() + margin, top);
    t0 = ray.t_min, t1 = ray.t_max;
    for (int k = 0; k < 3; ++k) {
        const double o = ray.origin[k] - stack.origin()[k], d = ray.direction[k];
        if (d == 0.0) {
            if (o < lo[k] || o > hi[k]) return false;
            continue;
        }
        const double a = (lo[k] - o) / d, b = (hi[k] - o) / d;
        t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
    }
    return t0 < t1;
}

std::vector<double> StackOracle::breakpoints(const Ray& ray, double t0, double t1) const
{
    const MaterialStack& stack = ground_.stack();
    const double s = stack.cell(), unit = stack.unit();
    const Vec3d o = ray.origin - stack.origin();
    std::vector<double> lines{t0, t1};
    for (int k = 0; k < 2; ++k) {
        const double d = ray.direction[k];
        if (d == 0.0) continue;
        const double a = o[k] + t0 * d, b = o[k] + t1 * d;
        const int first = static_cast<int>(std::floor((std::min(a, b) - sigma_) / s)),
                  last = static_cast<int>(std::ceil((std::max(a, b) + sigma_) / s));
        for (int i = first; i <= last; ++i)
            for (const double line : {i * s - sigma_, i * s + sigma_}) lines.push_back((line - o[k]) / d);
    }
    std::sort(lines.begin(), lines.end());

    // Between two vertical planes the same columns lie under the kernel; their layers bend the field in z.
    std::vector<double> all;
    for (std::size_t n = 0; n + 1 < lines.size(); ++n) {
        const double from = std::max(lines[n], t0), to = std::min(lines[n + 1], t1);
        if (!(from < to)) continue;
        all.push_back(from), all.push_back(to);
        if (ray.direction.z == 0.0) continue;
        const Vec3d m = o + ray.direction * (0.5 * (from + to));
        for (int j = static_cast<int>(std::floor((m.y - sigma_) / s)); j <= static_cast<int>(std::floor((m.y + sigma_) / s)); ++j) {
            for (int i = static_cast<int>(std::floor((m.x - sigma_) / s)); i <= static_cast<int>(std::floor((m.x + sigma_) / s)); ++i) {
                ground_.for_each_run(i, j, [&](const Run& run) {
                    for (const double z :
                         {run.bottom * unit - sigma_, run.bottom * unit + sigma_, run.top * unit - sigma_, run.top * unit + sigma_}) {
                        const double t = (z - o.z) / ray.direction.z;
                        if (t > from && t < to) all.push_back(t);
                    }
                });
            }
        }
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::vector<CertifiedStretch> StackOracle::stretches(const Ray& ray, double t0, double t1, double margin) const
{
    std::vector<CertifiedStretch> result;
    const auto append = [&](double from, double to, bool inside, double depth) {
        if (!(from < to)) return;
        // Joined if nothing lies between: the cubics agree at a breakpoint.
        if (!result.empty() && result.back().inside == inside && result.back().to == from) {
            result.back().to = to;
            result.back().depth = std::max(result.back().depth, depth);
        } else {
            result.push_back({from, to, inside, depth});
        }
    };
    const std::vector<double> t = breakpoints(ray, t0, t1);
    for (std::size_t n = 0; n + 1 < t.size(); ++n) {
        const double a = t[n], h = t[n + 1] - t[n];
        const Power p({value(ray.at(a)), value(ray.at(a + h / 3.0)), value(ray.at(a + 2.0 * h / 3.0)), value(ray.at(t[n + 1]))});
        const std::vector<double> parts = monotone_parts(p);
        for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
            const double u0 = parts[k], u1 = parts[k + 1], f0 = p(u0), f1 = p(u1);
            for (const bool inside : {f0 < f1, f0 >= f1}) {  // in the order of the ray
                const double level = inside ? -margin : margin;
                const auto beyond = [&](double f) { return inside ? f < level : f > level; };
                if (!beyond(f0) && !beyond(f1)) continue;
                const double from = beyond(f0) ? u0 : passage(p, u0, u1, level), to = beyond(f1) ? u1 : passage(p, u0, u1, level);
                append(from == 0.0 ? a : a + from * h, to == 1.0 ? t[n + 1] : a + to * h, inside, std::max(std::abs(f0), std::abs(f1)));
            }
        }
    }
    return result;
}

RayVerdict judge(const StackOracle& oracle, const Ray& ray, double t, double error)
{
    RayVerdict verdict;
    if (std::isfinite(t)) {
        verdict.value = oracle.value(ray.at(t));
        verdict.false_hit = !(std::abs(verdict.value) <= error) || !(t > ray.t_min && t < ray.t_max);
    }
    double t0 = 0.0, t1 = 0.0;
    if (!oracle.domain_interval(ray, t0, t1)) return verdict;
    const std::vector<CertifiedStretch> s = oracle.stretches(ray, t0, std::min(t1, t), error);
    for (std::size_t k = 1; k < s.size(); ++k) {
        if (s[k].inside == s[k - 1].inside || (ray.crossing == Crossing::entering && !s[k].inside)) continue;
        verdict.missed = true;
        verdict.at = s[k].from;
        break;
    }
    return verdict;
}

}  // namespace hoodoo::testing
