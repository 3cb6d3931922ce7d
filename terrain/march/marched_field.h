// What is marched in patches: a function of space and shutter time, with what is proved of it over boxes.
#pragma once

#include "terrain/fields/warped_field.h"

namespace hoodoo
{

/// One function for each shutter time in [0, 1]. Pure and thread-safe.
class MarchedField
{
public:
    /// Points that values() takes at once: a SIMD register of the widest kind.
    static constexpr int batch = 8;

    virtual ~MarchedField() = default;
    virtual double value(const Vec3d& p, double time) const = 0;
    /// Whether values() costs less than two or three times value(); rays are then searched that many points at a time.
    virtual bool batched() const { return false; }
    /// value() of the first `count` points.
    virtual void values(const Vec3d (&p)[batch], int count, double time, double* out) const
    {
        for (int i = 0; i < count; ++i) out[i] = value(p[i], time);
    }
    /// Proved, for all times. An empty range of values says that nothing exists anywhere in the box.
    virtual LocalField local(const Box3d& box) const = 0;
    /// Where the surface exists: a crossing elsewhere is none.
    virtual bool exists(const Vec3d& p, double time) const = 0;
    /// Whether it certainly exists all over the box.
    virtual bool exists_throughout(const Box3d&) const { return false; }

    /// For the paper's mode: where the point came from, and the base there.
    virtual Vec3d inverse(const Vec3d& p, double time) const = 0;
    virtual double base_value(const Vec3d& q) const = 0;
};

}  // namespace hoodoo
