// Bodies and densities in closed form, for light to pass.
#pragma once

#include "renderer/media/media.h"
#include "terrain/density.h"
#include "terrain/surface.h"

#include <algorithm>
#include <cmath>

namespace hoodoo::testing
{

/// A full sphere around the origin.
class Ball final : public Surface
{
public:
    explicit Ball(double radius = 1.0, std::string material = "wall") : radius_(radius), material_(std::move(material)) {}
    std::uint32_t patch_count(std::uint32_t) const override { return 1; }
    Box3d patch_bounds(PatchId) const override { return Box3d(Vec3d(-1.001 * radius_), Vec3d(1.001 * radius_)); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        ++hit.evaluations;
        const double b = ray.origin.dot(ray.direction), d = b * b - ray.origin.length2() + radius_ * radius_;
        if (!(d > 0.0)) return false;
        for (const double t : {-b - std::sqrt(d), -b + std::sqrt(d)}) {
            if (ray.crossing == Crossing::entering && t > -b) continue;
            if (!(t > ray.t_min && t < hit.t)) continue;
            hit.t = t;
            hit.patch = patch;
            return true;
        }
        return false;
    }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction it;
        it.t = hit.t;
        const Vec3d n = ray.at(hit.t).normalized();
        it.position = n * radius_;
        it.position_error = 1e-13 * radius_;
        it.spawn_offset = 1e-10 * radius_;
        it.geometric_normal = it.shading_normal = n;
        it.texture_point = it.position;
        it.materials.add(0, 1.0f);
        return it;
    }
    bool contains(const Vec3d& p) const override { return p.length() <= radius_; }
    std::vector<std::string> materials() const override { return {material_}; }
    bool closed() const override { return true; }
    SurfaceInfo info() const override { return {}; }

private:
    double radius_;
    std::string material_;
};

/// Water below z = amplitude sin(2 pi x / wavelength), in a square of twice `extent` metres; amplitude 0: flat. (A tracer's error on the triangles of
/// a scene grows with the scene.)
class SineSea final : public Surface
{
public:
    explicit SineSea(double amplitude, double wavelength = 1.0, double extent = 100.0)
        : a_(amplitude), k_(2.0 * 3.14159265358979323846 / wavelength), extent_(extent)
    {
    }
    std::uint32_t patch_count(std::uint32_t) const override { return 1; }
    Box3d patch_bounds(PatchId) const override { return Box3d(Vec3d(-extent_, -extent_, -a_ - 1e-6), Vec3d(extent_, extent_, a_ + 1e-6)); }
    bool intersect(PatchId patch, const Ray& ray, Hit& hit) const override
    {
        double low = ray.t_min, high = hit.t;
        const double z = ray.origin.z, d = ray.direction.z, pad = a_ + 1e-9;
        if (d == 0.0 && std::abs(z) > pad) return false;
        if (d != 0.0) {
            low = std::max(low, std::min((-pad - z) / d, (pad - z) / d));
            high = std::min(high, std::max((-pad - z) / d, (pad - z) / d));
        }
        if (!(low < high)) return false;

        // Steps over which f, whose slope is at most 1 + a k, keeps its sign; then bisection.
        const double slope = std::abs(d) + a_ * k_ * std::abs(ray.direction.x);
        double t = low, f = value(ray.at(t));
        while (t < high) {
            const double next = std::min(high, t + std::max(std::abs(f) / slope, 1e-6)), g = value(ray.at(next));
            ++hit.evaluations;
            if ((f > 0.0) != (g > 0.0)) {
                const bool enters = f > 0.0;
                if (enters || ray.crossing == Crossing::any) {
                    double in = t, out = next;
                    for (int i = 0; i < 60; ++i) {
                        const double mid = 0.5 * (in + out);
                        ((value(ray.at(mid)) > 0.0) == enters ? in : out) = mid;
                    }
                    hit.t = out;
                    hit.patch = patch;
                    return out < high;
                }
            }
            t = next;
            f = g;
        }
        return false;
    }
    Interaction interact(const Ray& ray, const Hit& hit) const override
    {
        Interaction it;
        it.t = hit.t;
        it.position = ray.at(hit.t);
        it.position_error = 1e-12 * (1.0 + hit.t);
        it.spawn_offset = 1e-8;
        it.geometric_normal = it.shading_normal = Vec3d(-a_ * k_ * std::cos(k_ * it.position.x), 0.0, 1.0).normalized();
        it.texture_point = it.position;
        it.materials.add(0, 1.0f);
        return it;
    }
    bool contains(const Vec3d& p) const override { return value(p) <= 0.0; }
    std::vector<std::string> materials() const override { return {"sea"}; }
    bool closed() const override { return false; }
    SurfaceInfo info() const override { return {}; }

private:
    double value(const Vec3d& p) const { return p.z - a_ * std::sin(k_ * p.x); }
    double a_, k_, extent_;
};

/// An even density in a ball around the origin.
class BallDensity final : public Density
{
public:
    explicit BallDensity(double radius = 1.0, double value = 1.0) : radius_(radius), value_(value) {}
    double value(const Vec3d& p, double) const override { return p.length() <= radius_ ? value_ : 0.0; }
    double majorant(const Box3d& box, const Interval&) const override
    {
        const Vec3d nearest(std::clamp(0.0, box.min.x, box.max.x), std::clamp(0.0, box.min.y, box.max.y), std::clamp(0.0, box.min.z, box.max.z));
        return nearest.length() <= radius_ ? value_ : 0.0;
    }
    Box3d bounds() const override { return Box3d(Vec3d(-radius_), Vec3d(radius_)); }

private:
    double radius_, value_;
};

/// What a density says of itself, in part untrue.
class UnderstatedDensity final : public Density
{
public:
    UnderstatedDensity(std::shared_ptr<const Density> density, double factor) : density_(std::move(density)), factor_(factor) {}
    double value(const Vec3d& p, double time) const override { return density_->value(p, time); }
    double majorant(const Box3d& box, const Interval& times) const override { return factor_ * density_->majorant(box, times); }
    Box3d bounds() const override { return density_->bounds(); }

private:
    std::shared_ptr<const Density> density_;
    double factor_;
};

}  // namespace hoodoo::testing
