// Spheroidal weathering of a cell with resistant contacts (Peytavie2009, section 5; Beardall2007), as a continuous function (maths A9).
//
// A face is worn by the air it sees: edges and corners see more, and S - M, the rise of a smooth maximum over the maximum, is 0 on a face, ln 2 /
// beta on an edge, ln 3 / beta at a corner. Resistance rho = max over the contacts = exp(-nearest^2 / w^2) stops the wear where the rock touches its
// neighbour; there Phi = M = 0 for both rocks, and since Phi >= M nowhere do they overlap.
// Slope: M + kappa (1 - rho) (S - M) mixes unit vectors, so at most 1; the second factor adds (e0 + kappa ln m / beta + a) max |grad rho|, with
// max |grad rho| = sqrt(2/e) / w = 0.8578 / w; the detail adds a times its own slope. Detail: three octaves of gradient noise mapped into [0, 1], so
// it only ever takes away. Deviations: the paper erodes voxels step by step; width 0.6 r instead of r, and few contacts (with all faces and width r
// the centre itself resists by 0.3). Missing: cracks; different hardness inside one rock.

#include "terrain/rocks/weathering.h"

#include "terrain/math/noise.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr double kGaussSlope = 0.85776388496070679;  // sqrt(2 / e)
constexpr Fractal kDetail{3.0, 2.2, 0.45};
constexpr double kDetailWavelength = 1.1;  // of the first octave, / r: about two bumps a rock's width

}  // namespace

RockField::RockField(const VoronoiCell& cell, std::vector<Vec3d> contacts, double radius, const Weathering& w)
    : contacts_(std::move(contacts)),
      box_(cell.box),
      radius_(radius),
      depth_(w.depth * radius),
      kappa_(w.exposure),
      beta_(w.sharpness / radius),
      width_(w.width * radius),
      amplitude_(w.roughness * radius),
      wavelength_(kDetailWavelength * radius),
      seed_(w.seed)
{
    for (const CellFace& face : cell.faces) planes_.push_back({face.normal, face.offset});
    const NoiseBound detail = fbm_bound(kNoise3Bound, kDetail);
    const double rise = std::log(static_cast<double>(planes_.size())) / beta_;
    slope_ = 1.0 + (depth_ + kappa_ * rise + amplitude_) * kGaussSlope / width_ + amplitude_ * 0.5 * detail.slope / detail.value / wavelength_;
}

RockField::Parts RockField::parts(const Vec3d& p) const
{
    Parts out{-kInfinity, 0.0, 0.0, 0, Vec3d(0.0), Vec3d(0.0)};
    for (std::size_t k = 0; k < planes_.size(); ++k) {
        const double s = planes_[k].normal.dot(p) - planes_[k].offset;
        if (s > out.m) out.m = s, out.top = k;
    }
    double sum = 0.0;
    for (const Plane& plane : planes_) {
        const double below = beta_ * (plane.normal.dot(p) - plane.offset - out.m);
        if (below < -36.0) continue;  // under half a unit in the last place of the sum, which is at least 1
        const double weight = std::exp(below);
        sum += weight;
        out.smooth += plane.normal * weight;
    }
    out.smooth /= sum;
    out.rise = std::log(sum) / beta_;

    double nearest = kInfinity;
    Vec3d to(0.0);
    for (const Vec3d& c : contacts_) {
        const Vec3d d = p - c;
        if (d.length2() < nearest) nearest = d.length2(), to = d;
    }
    out.rho = std::exp(-nearest / (width_ * width_));
    if (out.rho > 0.0) out.rho_gradient = to * (-2.0 * out.rho / (width_ * width_));
    return out;
}

RockField::Sample RockField::sample(const Vec3d& p) const
{
    const Parts a = parts(p);
    double wear = depth_ + kappa_ * a.rise;
    const Vec3d top = planes_[a.top].normal;
    Vec3d wear_gradient = (a.smooth - top) * kappa_;
    if (amplitude_ > 0.0) {
        const Noise3 n = fbm(p / wavelength_, seed_, kDetail);
        const double bound = fbm_bound(kNoise3Bound, kDetail).value;
        wear += amplitude_ * 0.5 * (1.0 + n.value / bound);
        wear_gradient += n.gradient * (amplitude_ * 0.5 / (bound * wavelength_));
    }
    return {a.m + wear * (1.0 - a.rho), top + wear_gradient * (1.0 - a.rho) - a.rho_gradient * wear};
}

double RockField::value(const Vec3d& p) const
{
    return sample(p).value;
}

Vec3d RockField::gradient(const Vec3d& p) const
{
    return sample(p).gradient;
}

double RockField::slope_bound(const Segment&) const
{
    return slope_;
}

Interval RockField::range(const Box3d& box) const
{
    const double middle = value(box.center()), reach = 0.5 * box.size().length() * slope_;
    return {middle - reach, middle + reach};
}

double RockField::plane_distance(const Vec3d& p) const
{
    return parts(p).m;
}

double RockField::smooth_distance(const Vec3d& p) const
{
    const Parts a = parts(p);
    return a.m + a.rise;
}

double RockField::resistance(const Vec3d& p) const
{
    return parts(p).rho;
}

double RockField::exit(const Vec3d& origin, const Vec3d& direction) const
{
    double t = kInfinity;
    for (const Plane& plane : planes_) {
        const double along = plane.normal.dot(direction);
        if (along > 0.0) t = std::min(t, (plane.offset - plane.normal.dot(origin)) / along);
    }
    return t;
}

}  // namespace hoodoo
