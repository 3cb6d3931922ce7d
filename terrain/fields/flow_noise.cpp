// Flows made of noise: along its gradient, and around its curl. No closed form: warp.cpp integrates them.
// Gamito2001, section 4.1: v = grad n(x, y) moves the line n = 0 at right angles to itself. In cells of the length w the flow is w grad n(p / w) / w
// = grad n at p / w, so |v| <= G, |Dv| <= H / w, |D2v| <= K / w^2 with the bounds of noise_hessian.h. Curl: v = curl (w a) = sum_l grad n_l x e_l of
// three noises a at p / w. For unit vectors e, u: e.v = sum_l grad n_l.(e_l x e), and its derivatives along u are at most sum over l and the cell's
// corners of |...|, as in noise_hessian.cpp, a closed form in (p, e, u) with the suprema below. Octave k has the amplitude gain^k and the frequency
// 2^k: it adds (2 gain)^k, (4 gain)^k / w, (8 gain)^k / w^2 times them, each faded as FadingOctave says.
#include "terrain/fields/flow.h"
#include "terrain/math/hash.h"
#include "terrain/math/noise_hessian.h"

#include <array>
#include <vector>

namespace hoodoo
{

namespace
{

class NoiseGradient final : public Flow
{
public:
    NoiseGradient(const Vec3d& origin, double wavelength, std::uint32_t seed, const std::optional<DetailView>& view)
        : origin_(origin), wavelength_(wavelength), seed_(seed), fading_(view, wavelength)
    {
    }
    Vec3d velocity(const Vec3d& p, double) const override
    {
        const Noise2 n = gradient_noise(place(p), seed_);
        return Vec3d(n.gradient.x, n.gradient.y, 0.0) * fading_.weight(p).value;
    }
    Matrix3d gradient(const Vec3d& p, double t) const override { return motion(p, t).gradient; }
    Motion motion(const Vec3d& p, double) const override
    {
        const NoiseJet2 n = noise_jet(place(p), seed_);
        const DetailFade::Weight w = fading_.weight(p);
        const Vec3d v(n.gradient.x, n.gradient.y, 0.0);
        return {v * w.value, Matrix3d(n.xx, n.xy, 0.0, n.xy, n.yy, 0.0, 0.0, 0.0, 0.0) * (w.value / wavelength_) + outer(v, w.gradient)};
    }
    FlowBound bound(const Box3d& box, const Interval&) const override
    {
        const NoiseDerivativeBound n = noise_bound(Imath::Box2d(place(box.min), place(box.max)), seed_);
        return fading_.bound(box, {n.slope, n.hessian / wavelength_, n.third / (wavelength_ * wavelength_), 0.0});
    }

private:
    Vec2d place(const Vec3d& p) const { return {(p.x - origin_.x) / wavelength_, (p.y - origin_.y) / wavelength_}; }
    Vec3d origin_;
    double wavelength_;
    std::uint32_t seed_;
    FadingOctave fading_;
};

class Curl final : public Flow
{
public:
    Curl(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed, const std::optional<DetailView>& view)
        : origin_(origin), wavelength_(wavelength)
    {
        for (std::uint32_t l = 0; l < 3; ++l) seeds_[l] = static_cast<std::uint32_t>(hash_cell(seed, l, 0));
        double amplitude = 1.0, frequency = 1.0;
        for (int k = 0; k < octaves; ++k, amplitude *= gain, frequency *= 2.0) {
            octaves_.push_back({amplitude,
                                frequency,
                                {std::pow(2.0 * gain, k) * kCurl.slope, std::pow(4.0 * gain, k) * kCurl.hessian / wavelength,
                                 std::pow(8.0 * gain, k) * kCurl.third / (wavelength * wavelength), 0.0},
                                FadingOctave(view, wavelength / frequency)});
            // No 1e6 samples reach two fifths of the bound.
            usual_ += 0.4 * octaves_.back().alone.gradient;
        }
    }

    Vec3d velocity(const Vec3d& p, double) const override
    {
        Vec3d v(0.0);
        for (std::uint32_t k = 0; k < octaves_.size(); ++k) {
            const double w = octaves_[k].fading.weight(p).value;
            if (w != 0.0) v += octave_velocity(p, k) * w;
        }
        return v;
    }

    Matrix3d gradient(const Vec3d& p, double) const override
    {
        Matrix3d m = Matrix3d() * 0.0;
        for (std::uint32_t k = 0; k < octaves_.size(); ++k) {
            const DetailFade::Weight w = octaves_[k].fading.weight(p);
            if (w.value == 0.0) continue;
            const Vec3d q = octave_place(p, k);
            std::array<NoiseJet3, 3> n;
            for (std::size_t l = 0; l < 3; ++l) n[l] = noise_jet(q, seeds_[l] + k);
            const auto &a = n[0], &b = n[1], &c = n[2];
            const Matrix3d d(c.xy - b.xz, c.yy - b.yz, c.yz - b.zz,   // of v.x = dc/dy - db/dz
                             a.xz - c.xx, a.yz - c.xy, a.zz - c.xz,   // of v.y = da/dz - dc/dx
                             b.xx - a.xy, b.xy - a.yy, b.xz - a.yz);  // of v.z = db/dx - da/dy
            m += d * (w.value * octaves_[k].amplitude * octaves_[k].frequency * octaves_[k].frequency / wavelength_);
            if (w.gradient != Vec3d(0.0)) m += outer(octave_velocity(p, k), w.gradient);
        }
        return m;
    }

    FlowBound bound(const Box3d& box, const Interval&) const override
    {
        FlowBound sum;
        for (const Octave& octave : octaves_) {
            const FlowBound b = octave.fading.bound(box, octave.alone);
            sum = {sum.speed + b.speed, sum.gradient + b.gradient, sum.hessian + b.hessian, 0.0};
        }
        return sum;
    }
    double usual_gradient() const override { return usual_; }

private:
    /// Suprema of |v|, |Dv|, |D2v| over all gradients.
    static constexpr NoiseDerivativeBound kCurl{6.3658, 21.064, 165.162};

    struct Octave {
        double amplitude, frequency;
        FlowBound alone;
        FadingOctave fading;
    };
    Vec3d octave_place(const Vec3d& p, std::uint32_t k) const
    {
        return (p - origin_) * (octaves_[k].frequency / wavelength_) + Vec3d(17.3, 31.7, 23.9) * k;
    }
    Vec3d octave_velocity(const Vec3d& p, std::uint32_t k) const
    {
        const Vec3d q = octave_place(p, k);
        std::array<Vec3d, 3> g;
        for (std::size_t l = 0; l < 3; ++l) g[l] = gradient_noise(q, seeds_[l] + k).gradient;
        return Vec3d(g[2].y - g[1].z, g[0].z - g[2].x, g[1].x - g[0].y) * (octaves_[k].amplitude * octaves_[k].frequency);
    }

    Vec3d origin_;
    double wavelength_, usual_ = 0.0;
    std::array<std::uint32_t, 3> seeds_{};
    std::vector<Octave> octaves_;
};

}  // namespace

FlowPtr noise_gradient_flow(const Vec3d& origin, double wavelength, std::uint32_t seed, const std::optional<DetailView>& view)
{
    return std::make_shared<NoiseGradient>(origin, wavelength, seed, view);
}

FlowPtr curl_flow(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed, const std::optional<DetailView>& view)
{
    return std::make_shared<Curl>(origin, wavelength, octaves, gain, seed, view);
}

}  // namespace hoodoo
