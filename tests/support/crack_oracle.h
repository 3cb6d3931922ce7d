// Cracks the long way: explicit polygons and segments, the paper's formulas as printed, certified marching. Shares no code with the product.
#pragma once

#include "terrain/surface.h"

#include <functional>
#include <string>
#include <vector>

namespace hoodoo::testing
{

/// Sites of the golden file: x = 1664525 x + 1013904223 mod 2^32 from 12345, u = (x >> 8) / 2^24.
std::vector<Vec2d> golden_sites(int n);

class CrackOracle
{
public:
    struct Parameters {
        double kappa = 0.3, psi = 0.4, epsilon = 0.2, width = 0.0;  ///< epsilon > 0
        double steepest = 0.0;                                      ///< of the height
    };
    /// Heights in [0, 1] over the unit square.
    CrackOracle(std::vector<Vec2d> sites, const Parameters& parameters, std::function<double(const Vec2d&)> height);

    struct Edge {
        Vec2d a, b;
    };
    /// Each border once, those without an end cut far outside the unit square.
    const std::vector<Edge>& edges() const { return edges_; }
    double distance(const Vec2d& p) const;
    const Edge& nearest(const Vec2d& p) const;
    /// Equation 1 as printed.
    double cracked_height(const Vec2d& p) const;

    /// What is wrong with `t` (infinity: a miss) as the first crossing of the kind ray.crossing, over the part of the ray above the unit square;
    /// empty if nothing is. A change of side is certain where |z - h'| > margin on both sides of it.
    std::string judge(const Ray& ray, double t, double margin) const;

private:
    struct Stretch {
        double from, to;
        bool cracked;
    };
    std::vector<Stretch> stretches(const Ray& ray) const;
    double iota(double h) const;

    Parameters p_;
    std::function<double(const Vec2d&)> height_;
    std::vector<Edge> edges_;
};

}  // namespace hoodoo::testing
