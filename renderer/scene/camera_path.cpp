// Poses between keys: cubic Hermite pieces whose slopes at the keys say how the camera passes them.
//
// With u in [0, 1] between keys k and k+1 at distance h in time, and slopes m at the keys,
//     p(u) = (2u^3 - 3u^2 + 1) p_k + (u^3 - 2u^2 + u) h m_k + (3u^2 - 2u^3) p_k+1 + (u^3 - u^2) h m_k+1.
// spline: m is the difference quotient over the two neighbours (Catmull1974, for uneven times), at the ends of the nearest piece: one curve, C1.
// ease: m = 0, so that the camera rests at each key. linear: u itself.
// Missing: eye and target are interpolated on their own, so that a turn of more than half a circle needs a key in its middle.
#include "renderer/scene/camera_path.h"

#include <algorithm>

namespace hoodoo
{
namespace
{

Pose blend(const Pose& a, double wa, const Pose& b, double wb)
{
    return {a.eye * wa + b.eye * wb, a.target * wa + b.target * wb, a.up * wa + b.up * wb, a.fov * wa + b.fov * wb};
}

bool equal(const Pose& a, const Pose& b)
{
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov == b.fov;
}

/// Change of the pose per second as the curve passes key k.
Pose slope(const std::vector<CameraPath::Key>& keys, std::size_t k)
{
    const std::size_t before = k > 0 ? k - 1 : k, after = k + 1 < keys.size() ? k + 1 : k;
    const double h = keys[after].time - keys[before].time;
    return blend(keys[after].pose, 1.0 / h, keys[before].pose, -1.0 / h);
}

}  // namespace

Pose CameraPath::at(double seconds) const
{
    if (seconds <= keys_.front().time) return keys_.front().pose;
    if (seconds >= keys_.back().time) return keys_.back().pose;
    const auto next = std::upper_bound(keys_.begin(), keys_.end(), seconds, [](double t, const Key& key) { return t < key.time; });
    const std::size_t k = static_cast<std::size_t>(next - keys_.begin()) - 1;
    const Key &a = keys_[k], &b = keys_[k + 1];
    const double h = b.time - a.time, u = (seconds - a.time) / h;
    if (easing_ == Easing::linear) return blend(a.pose, 1.0 - u, b.pose, u);
    const double rise = u * u * (3.0 - 2.0 * u);
    const Pose between = blend(a.pose, 1.0 - rise, b.pose, rise);
    if (easing_ == Easing::ease) return between;
    const Pose bend = blend(slope(keys_, k), h * u * (1.0 - u) * (1.0 - u), slope(keys_, k + 1), -h * u * u * (1.0 - u));
    return blend(between, 1.0, bend, 1.0);
}

bool CameraPath::moves(double from, double to) const
{
    if (!(from < to)) return false;
    for (std::size_t k = 0; k + 1 < keys_.size(); ++k) {
        if (!(keys_[k].time < to && keys_[k + 1].time > from)) continue;
        // A spline passes two equal keys with speed if their neighbours differ.
        const bool wide = easing_ == Easing::spline;
        const std::size_t first = wide && k > 0 ? k - 1 : k, last = wide && k + 2 < keys_.size() ? k + 2 : k + 1;
        for (std::size_t i = first; i < last; ++i)
            if (!equal(keys_[i].pose, keys_[i + 1].pose)) return true;
    }
    return false;
}

}  // namespace hoodoo
