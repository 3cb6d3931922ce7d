// The truth about a ray and a convolution surface: every crossing, with a certificate, in double precision. Independent of terrain/march.
#pragma once

#include "terrain/stack/convolution.h"

#include <vector>

namespace hoodoo::testing
{

/// A maximal stretch of a ray on which f is certainly on one side: f > margin (air) or f < -margin (matter).
struct CertifiedStretch {
    double from, to;  ///< metres along the ray
    bool inside;
    double depth;  ///< largest |f| certified on it
};

/// Where along a ray the field is certainly positive or negative, from the definition of the field alone.
///
/// All breakpoints are taken: x, y in {grid line +- sigma}, z in {layer bound +- sigma} of the columns near the ray. Between two of them f is a
/// cubic, fitted through four values of the field summed box by box here; its monotone parts are cut where it passes +-margin, by bisection. A
/// stretch certifies the sign of f at every point of it. What lies between stretches has |f| <= margin at some places and may be anything there.
class StackOracle
{
public:
    StackOracle(const Ground& ground, double sigma) : ground_(ground), sigma_(sigma) {}

    /// Stretches in (t0, t1) with |f| > margin, in order. The caller keeps the ray inside the surface's domain (domain_interval).
    std::vector<CertifiedStretch> stretches(const Ray& ray, double t0, double t1, double margin) const;

    /// f by its definition: the sum over columns of the overlap of boxes.
    double value(const Vec3d& p) const;

    /// The part of a ray over the terrain: [0, n] cells in x and y with `extend`, a cell more around a `cut` block; heights where |f| < 1.
    /// False if there is none.
    bool domain_interval(const Ray& ray, double& t0, double& t1) const;

private:
    std::vector<double> breakpoints(const Ray& ray, double t0, double t1) const;
    const Ground& ground_;
    double sigma_;
};

/// What is wrong with a tracer's answer about a ray. Empty: nothing.
/// `t`: the reported distance (infinity: a miss). A miss is a change of side of the kind ray.crossing, certified by |f| > error, that ends before t.
/// A false hit: the field at t is farther from 0 than error.
struct RayVerdict {
    bool missed = false, false_hit = false;
    double at = 0.0;     ///< of the missed crossing
    double value = 0.0;  ///< f at the reported t
};
RayVerdict judge(const StackOracle& oracle, const Ray& ray, double t, double error);

}  // namespace hoodoo::testing
