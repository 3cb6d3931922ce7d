// Where light comes from: a closed set of things infinitely far away, each with its radiance, a sampler and the sampler's density side by side.
#pragma once

#include "renderer/light/sky.h"
#include "terrain/schema.h"

#include <functional>
#include <span>
#include <variant>
#include <vector>

namespace hoodoo
{

/// A direction towards a light. `pdf` per steradian; 0 for a delta light, whose `value` is then an irradiance.
struct LightSample {
    Vec3d direction{0.0};
    Vec3f value{0.0f};  ///< radiance, W/m2/sr a channel; delta: irradiance on a plane that faces the light, W/m2 a channel
    double pdf = 0.0;
    bool delta = false;
};

/// The sun as one direction: sharp shadows.
class DeltaSun
{
public:
    DeltaSun(const Vec3d& direction, const Vec3f& irradiance) : direction_(direction), irradiance_(irradiance) {}
    static constexpr bool sampled = true;
    Vec3f radiance(const Vec3d&) const { return Vec3f(0.0f); }
    double pdf(const Vec3d&) const { return 0.0; }
    LightSample sample(const Vec2d&) const { return {direction_, irradiance_, 0.0, true}; }

private:
    Vec3d direction_;
    Vec3f irradiance_;
};

/// The sun as an evenly bright disc.
class DiscSun
{
public:
    /// `direction` unit, towards the disc's middle; `irradiance` on a plane that faces it; `diameter` in radians.
    DiscSun(const Vec3d& direction, const Vec3f& irradiance, double diameter);
    static constexpr bool sampled = true;
    Vec3f radiance(const Vec3d& w) const { return inside(w) ? radiance_ : Vec3f(0.0f); }
    double pdf(const Vec3d& w) const { return inside(w) ? pdf_ : 0.0; }
    LightSample sample(const Vec2d& u) const;

private:
    bool inside(const Vec3d& w) const { return (w - direction_).length2() <= chord2_; }

    Vec3d direction_, tangent_, bitangent_;
    double chord2_ = 0.0;  ///< squared chord from the middle to the rim: precise where a cosine is not
    double pdf_ = 0.0;
    Vec3f radiance_{0.0f};
};

/// The same radiance from everywhere. It takes no shadow rays: the scattered ray itself is the better sample of it.
class ConstantSky
{
public:
    explicit ConstantSky(const Vec3f& radiance) : radiance_(radiance) {}
    static constexpr bool sampled = false;
    Vec3f radiance(const Vec3d&) const { return radiance_; }
    double pdf(const Vec3d&) const { return 0.0; }
    LightSample sample(const Vec2d&) const { return {}; }

private:
    Vec3f radiance_;
};

/// The clear sky, from a table made by renderer/light/sky.h.
class ClearSky
{
public:
    explicit ClearSky(std::shared_ptr<const SkyTable> table) : table_(std::move(table)) {}
    static constexpr bool sampled = true;
    Vec3f radiance(const Vec3d& w) const { return table_->radiance(w); }
    double pdf(const Vec3d& w) const { return table_->pdf(w); }
    LightSample sample(const Vec2d& u) const;

private:
    std::shared_ptr<const SkyTable> table_;
};

/// Each has radiance(w), sample(u) and pdf(w), and `sampled`: whether shadow rays are sent to it. What is not sampled, or has density 0 in a
/// direction, is found by scattered rays alone.
using Light = std::variant<DeltaSun, DiscSun, ConstantSky, ClearSky>;

/// One schema a kind; its name is the `type` of a [light.NAME] table.
std::span<const Schema> light_schemas();

/// The lights that one [light.NAME] table of kind `type` stands for (a sky brings its sun). `haze`: vertical optical depth of aerosol that the scene
/// has as a medium of its own, and that the sky's air therefore lacks. Throws Error (scene) at the value's position.
std::vector<Light> make_lights(const std::string& type, const Values& values, const std::function<Vec3f(const ColorValue&)>& to_rendering,
                               double haze = 0.0);

/// Unit vector towards `elevation` above the horizon and `azimuth` from north (+y) over east (+x), radians.
Vec3d compass_direction(double elevation, double azimuth);

}  // namespace hoodoo
