// Where a camera stands as time goes by: key poses and the way from one to the next.
#pragma once

#include "terrain/math/vec.h"

#include <vector>

namespace hoodoo
{

/// World space, metres; `fov` in radians.
struct Pose {
    Vec3d eye{0.0}, target{0, 1, 0}, up{0, 0, 1};
    double fov = 0.8726646259971648;
};

/// spline: a smooth curve through all keys, with speed where it passes a key. ease: comes to rest at every key. linear: at even speed, with corners.
enum class Easing { spline, ease, linear };

/// A pure function of time; holds the first pose before the first key and the last one after the last.
class CameraPath
{
public:
    struct Key {
        double time = 0.0;  ///< seconds
        Pose pose;
    };

    explicit CameraPath(const Pose& fixed) : keys_{{0.0, fixed}} {}
    /// At least one key, times strictly increasing.
    CameraPath(std::vector<Key> keys, Easing easing) : keys_(std::move(keys)), easing_(easing) {}

    Pose at(double seconds) const;
    /// False only if the pose is the same at all times of [from, to].
    bool moves(double from, double to) const;

private:
    std::vector<Key> keys_;
    Easing easing_ = Easing::spline;
};

}  // namespace hoodoo
