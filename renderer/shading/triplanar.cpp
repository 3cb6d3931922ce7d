// Triplanar projection (Peytavie2009, section 5) with its two misprints corrected, and normals raised by a height's gradient (Mikkelsen2020).
//
// Weights: w_k = |n_k|^p / sum_j |n_j|^p. The paper divides by the p-norm, so that its weights sum to as little as 0.056, and pairs |n_x| with
// the plane (x, y); here |n_x| weights the plane (y, z), and the coordinates keep their sign: |x| would mirror the texture at 0.
// Normals: a height map of slopes d over the plane of the axes (a, b) is a function of space with the gradient d_a e_a + d_b e_b; gradients of
// several maps add with the weights, and the normal is n - (g - (g.n) n), normalised.
// Missing: rotation of the projected planes.

#include "renderer/shading/triplanar.h"

#include <algorithm>

namespace hoodoo
{

Vec3d triplanar_weights(const Vec3d& n, double exponent)
{
    // Dividing by the largest component first keeps a large exponent from underflowing to 0 / 0.
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    const Vec3d w(std::pow(std::abs(n.x) / largest, exponent), std::pow(std::abs(n.y) / largest, exponent),
                  std::pow(std::abs(n.z) / largest, exponent));
    return w / (w.x + w.y + w.z);
}

Vec3d triplanar_lookup_weights(const Vec3d& n, double exponent)
{
    constexpr double unseen = 0.01;
    Vec3d w = triplanar_weights(n, exponent);
    for (unsigned k = 0; k < 3; ++k) w[k] = std::max(w[k] - unseen, 0.0);
    return w / (w.x + w.y + w.z);
}

Vec3d bumped_normal(const Vec3d& n, const Vec3d& g, const Vec3d& geometric)
{
    constexpr double lowest_cosine = 0.05;  // about 87 degrees: beyond it almost no light could reach the surface
    Vec3d bumped = (n - (g - n * n.dot(g))).normalized();
    const double cosine = bumped.dot(geometric);
    if (cosine < lowest_cosine) {
        // Keep the sideways direction, set the angle.
        const Vec3d sideways = bumped - geometric * cosine;
        const double length = sideways.length();
        bumped = length > 0.0 ? geometric * lowest_cosine + sideways * (std::sqrt(1.0 - lowest_cosine * lowest_cosine) / length) : geometric;
    }
    return bumped;
}

}  // namespace hoodoo
