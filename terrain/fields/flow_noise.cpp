// Flows made of noise: along its gradient, and around its curl. No closed form: warp.cpp integrates them.
// Gamito2001, section 4.1: v = grad n(x, y) moves the line n = 0 at right angles to itself. In cells of the length w the flow is w grad n(p / w) / w
// = grad n at p / w, so |v| <= G, |Dv| <= H / w, |D2v| <= K / w^2 with the bounds of noise_hessian.h. Curl: v = curl (w a) = sum_l grad n_l x e_l of
// three noises a at p / w. For unit vectors e, u: e.v = sum_l grad n_l.(e_l x e), and its derivatives along u are at most sum over l and the cell's
// corners of |...|, as in noise_hessian.cpp, a closed form in (p, e, u) with the suprema below. Octave k has the amplitude gain^k and the frequency
// 2^k: it adds (2 gain)^k, (4 gain)^k / w, (8 gain)^k / w^2 times them.
#include "terrain/fields/flow.h"
#include "terrain/math/hash.h"
#include "terrain/math/noise_hessian.h"

#include <array>

namespace hoodoo
{

namespace
{

class NoiseGradient final : public Flow
{
public:
    NoiseGradient(const Vec3d& origin, double wavelength, std::uint32_t seed) : origin_(origin), wavelength_(wavelength), seed_(seed) {}
    Vec3d velocity(const Vec3d& p, double) const override
    {
        const Noise2 n = gradient_noise(place(p), seed_);
        return {n.gradient.x, n.gradient.y, 0.0};
    }
    Matrix3d gradient(const Vec3d& p, double t) const override { return motion(p, t).gradient; }
    Motion motion(const Vec3d& p, double) const override
    {
        const NoiseJet2 n = noise_jet(place(p), seed_);
        return {{n.gradient.x, n.gradient.y, 0.0}, Matrix3d(n.xx, n.xy, 0.0, n.xy, n.yy, 0.0, 0.0, 0.0, 0.0) * (1.0 / wavelength_)};
    }
    FlowBound bound(const Box3d& box, const Interval&) const override
    {
        const NoiseDerivativeBound n = noise_bound(Imath::Box2d(place(box.min), place(box.max)), seed_);
        return {n.slope, n.hessian / wavelength_, n.third / (wavelength_ * wavelength_), 0.0};
    }

private:
    Vec2d place(const Vec3d& p) const { return {(p.x - origin_.x) / wavelength_, (p.y - origin_.y) / wavelength_}; }
    Vec3d origin_;
    double wavelength_;
    std::uint32_t seed_;
};

class Curl final : public Flow
{
public:
    Curl(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed)
        : origin_(origin), wavelength_(wavelength), octaves_(octaves), gain_(gain)
    {
        for (std::uint32_t l = 0; l < 3; ++l) seeds_[l] = static_cast<std::uint32_t>(hash_cell(seed, l, 0));
        for (int k = 0; k < octaves; ++k) {
            bound_.speed += std::pow(2.0 * gain, k) * kCurl.slope;
            bound_.gradient += std::pow(4.0 * gain, k) * kCurl.hessian / wavelength;
            bound_.hessian += std::pow(8.0 * gain, k) * kCurl.third / (wavelength * wavelength);
        }
    }

    Vec3d velocity(const Vec3d& p, double) const override
    {
        Vec3d v(0.0);
        for_octaves(p, [&](const Vec3d& q, std::uint32_t k, double amplitude, double frequency) {
            std::array<Vec3d, 3> g;
            for (std::size_t l = 0; l < 3; ++l) g[l] = gradient_noise(q, seeds_[l] + k).gradient;
            v += Vec3d(g[2].y - g[1].z, g[0].z - g[2].x, g[1].x - g[0].y) * (amplitude * frequency);
        });
        return v;
    }

    Matrix3d gradient(const Vec3d& p, double) const override
    {
        Matrix3d m = Matrix3d() * 0.0;
        for_octaves(p, [&](const Vec3d& q, std::uint32_t k, double amplitude, double frequency) {
            std::array<NoiseJet3, 3> n;
            for (std::size_t l = 0; l < 3; ++l) n[l] = noise_jet(q, seeds_[l] + k);
            const auto &a = n[0], &b = n[1], &c = n[2];
            const Matrix3d d(c.xy - b.xz, c.yy - b.yz, c.yz - b.zz,   // of v.x = dc/dy - db/dz
                             a.xz - c.xx, a.yz - c.xy, a.zz - c.xz,   // of v.y = da/dz - dc/dx
                             b.xx - a.xy, b.xy - a.yy, b.xz - a.yz);  // of v.z = db/dx - da/dy
            m += d * (amplitude * frequency * frequency / wavelength_);
        });
        return m;
    }

    FlowBound bound(const Box3d&, const Interval&) const override { return bound_; }
    /// No 1e6 samples reach two fifths of the bound.
    double usual_gradient() const override { return 0.4 * Flow::usual_gradient(); }

private:
    /// Suprema of |v|, |Dv|, |D2v| over all gradients.
    static constexpr NoiseDerivativeBound kCurl{6.3658, 21.064, 165.162};

    Vec3d octave_place(const Vec3d& p, int k, double frequency) const
    {
        return (p - origin_) * (frequency / wavelength_) + Vec3d(17.3, 31.7, 23.9) * k;
    }

    template <class F>
    void for_octaves(const Vec3d& p, F&& octave) const
    {
        double amplitude = 1.0, frequency = 1.0;
        for (int k = 0; k < octaves_; ++k) {
            octave(octave_place(p, k, frequency), static_cast<std::uint32_t>(k), amplitude, frequency);
            amplitude *= gain_;
            frequency *= 2.0;
        }
    }

    Vec3d origin_;
    double wavelength_;
    int octaves_;
    double gain_;
    std::array<std::uint32_t, 3> seeds_{};
    FlowBound bound_;
};

}  // namespace

FlowPtr noise_gradient_flow(const Vec3d& origin, double wavelength, std::uint32_t seed)
{
    return std::make_shared<NoiseGradient>(origin, wavelength, seed);
}

FlowPtr curl_flow(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed)
{
    return std::make_shared<Curl>(origin, wavelength, octaves, gain, seed);
}

}  // namespace hoodoo
