// Cliffs and ledges from bedding: a slope that erosion would make even is steep where a bed is hard and flat where it is soft.
// No paper; the profile of layered desert cliffs. Bed k has thickness t_k = thickness (0.4 + 1.2 u) and a resistance that alternates, hard and soft,
// with some irregularity. An even slope spends a share (1 - contrast) t_k of its height on a hard bed and (1 + contrast) t_k on a soft one, so the
// map even -> bedded is piecewise linear with slope t_k / share_k; both ends are then scaled to the same range. Missing: folded or dipping beds;
// recesses of soft beds under hard ones (a matter of edits, not of heights).
#include "terrain/fields/strata.h"

#include "terrain/math/hash.h"

#include <algorithm>

namespace hoodoo
{

Strata::Strata(double low, double high, double thickness, double contrast, std::uint64_t seed)
{
    double z = low, h = low;
    even_.push_back(h);
    bedded_.push_back(z);
    for (std::uint64_t k = 0; z < high && k < 100000; ++k) {
        const double t = thickness * (0.4 + 1.2 * unit_real(hash_combine(seed, 2 * k)));
        const double irregular = 0.6 + 0.4 * unit_real(hash_combine(seed, 2 * k + 1));
        const double share = k % 2 == 0 ? 1.0 - contrast * irregular : 1.0 + contrast * irregular;
        const double top = std::min(z + t, high);
        h += share * (top - z);
        z = top;
        even_.push_back(h);
        bedded_.push_back(z);
    }
    const double scale = even_.back() > low ? (high - low) / (even_.back() - low) : 1.0;
    for (double& e : even_) e = low + (e - low) * scale;
}

double Strata::operator()(double h) const
{
    if (!(h > even_.front() && h < even_.back())) return h;
    const std::size_t k = static_cast<std::size_t>(std::upper_bound(even_.begin(), even_.end(), h) - even_.begin());
    const double u = (h - even_[k - 1]) / (even_[k] - even_[k - 1]);
    return bedded_[k - 1] + u * (bedded_[k] - bedded_[k - 1]);
}

}  // namespace hoodoo
