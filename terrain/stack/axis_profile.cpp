// Along a vertical line the kernel's overlaps with the columns do not change, so f is a sum of ramps: piecewise linear, each piece's root in closed
// form. Peytavie2009, sections 3.3 and 4.1: with weights w of the columns and layer bounds z_k, df/dz changes at z_k - sigma and z_k + sigma, and
//   f(z) = 1 - sum w D(z) / (4 sigma^3),   D the matter of a column in [z - sigma, z + sigma].
// Summed from the lowest knot upwards; the error is that of as many additions as there are knots. Missing: nothing.
#include "terrain/stack/axis_profile.h"

#include "terrain/stack/window.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

struct Bend {
    double z, slope;
};

}  // namespace

AxisProfile::AxisProfile(const Ground& ground, double sigma, double x, double y)
{
    const MaterialStack& stack = ground.stack();
    const double half = sigma / stack.cell(), tall = sigma / stack.unit();
    const Window wx = window(x, half, stack.size().x), wy = window(y, half, stack.size().y);
    std::vector<Bend> bends;
    double volume = 0.0;  // cells^2 units, below the first bend
    for (int j = wy.first; j <= wy.last; ++j) {
        for (int i = wx.first; i <= wx.last; ++i) {
            const double w = wx.weight(i) * wy.weight(j);
            if (!(w > 0.0)) continue;
            ground.for_each_run(i, j, [&](Run run) {
                if (run.bottom == Ground::bottomless) {
                    volume += w * 2.0 * tall;
                } else {
                    bends.push_back({run.bottom - tall, w});
                    bends.push_back({run.bottom + tall, -w});
                }
                bends.push_back({run.top - tall, -w});
                bends.push_back({run.top + tall, w});
            });
        }
    }
    std::sort(bends.begin(), bends.end(), [](const Bend& a, const Bend& b) { return a.z < b.z; });
    const double scale = 1.0 / (4.0 * half * half * tall);
    double slope = 0.0;
    for (std::size_t k = 0; k < bends.size();) {
        const double z = bends[k].z;
        if (!knots_.empty()) volume += slope * (z - knots_.back().z);
        knots_.push_back({z, 1.0 - scale * volume});
        for (; k < bends.size() && bends[k].z == z; ++k) slope += bends[k].slope;
    }
    if (knots_.empty()) knots_.push_back({0.0, 1.0 - scale * volume});
}

double AxisProfile::at(double z) const
{
    const auto next = std::upper_bound(knots_.begin(), knots_.end(), z, [](double height, const Knot& k) { return height < k.z; });
    if (next == knots_.begin()) return knots_.front().f;
    if (next == knots_.end()) return knots_.back().f;
    const Knot &a = *(next - 1), &b = *next;
    return a.f + (b.f - a.f) * ((z - a.z) / (b.z - a.z));
}

std::vector<double> AxisProfile::roots() const
{
    std::vector<double> roots;
    for (std::size_t k = 1; k < knots_.size(); ++k) {
        const Knot &a = knots_[k - 1], &b = knots_[k];
        if ((a.f < 0.0) != (b.f < 0.0)) roots.push_back(a.z + (b.z - a.z) * (a.f / (a.f - b.f)));
    }
    return roots;
}

}  // namespace hoodoo
