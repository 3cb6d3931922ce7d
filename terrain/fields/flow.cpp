// Flows whose paths are known in closed form.
// Gamito2001, section 2: a surface carried by a Lipschitz flow stays one surface and does not cut itself; "one should always give preference to
// flow fields such that equation (1) has an analytical solution". With q = p - centre, a the axis, r the distance from it:
//   rotation  v = a x q                          turns q by t
//   vortex    v = w(r) a x q, w = e^{-r^2/R^2}   r is constant, so it turns q by w(r) t
//   bulge     v = q (1 - u), u = |q|^2 / R^2     u' = 2u (1 - u) is logistic: u(t) = u E / (1 + u (E - 1)), E = e^{2t}
//   shear     v = s (n.q), s perpendicular to n  n.q is constant: q + t s (n.q)
//   vertical  v = (0, 0, f(x, y))                x and y are constant: z + t f
// Bounds. Vortex: with x = r/R, |v| = R x e^{-x^2} <= R / sqrt(2e). Dv = w [a]x + (dw/dr)(a x q) e_r^T: norm at most w max(1, |1 - 2 x^2|) <= 1.
// D2v(u, u) = 2 (grad w.u) a x u + D2w(u, u) a x q is a closed form in r and u; its supremum 1.9518 / R was found numerically. Bulge: |v| <= R
// 2/sqrt(27), |Dv| <= 2 (its eigenvalues are 1 - u and 1 - 3u), D2v =
// -(2/R^2)(q I + sym), norm 6|q|/R^2 <= 6/R inside; at the sphere Dv jumps, so there is no bound of D2v across it. A fading octave w v: |D(wv)| <= w
// |Dv| + |w'||v|, |D2(wv)| <= w |D2v| + 2 |w'||Dv| + |w''||v|; of the vertical flow by the horizontal distance, which leaves its closed form.
#include "terrain/fields/flow.h"

#include "terrain/error.h"
#include "terrain/math/noise_hessian.h"

#include <algorithm>

namespace hoodoo
{

Carried Flow::carry(const Vec3d&, double) const
{
    throw Error(ErrorKind::internal, "a flow without a closed form was asked for one");
}

FlowBound FadingOctave::bound(const Box3d& box, const FlowBound& alone) const
{
    if (!fade_) return alone;
    const DetailFade::Bound w = fade_->over(box, axes_);
    return {w.value.hi * alone.speed, w.value.hi * alone.gradient + w.slope * alone.speed,
            w.value.hi * alone.hessian + 2.0 * w.slope * alone.gradient + w.curve * alone.speed, alone.drift};
}

double Flow::usual_gradient() const
{
    return bound(Box3d(Vec3d(-kInfinity), Vec3d(kInfinity)), {0.0, 1.0}).gradient;
}

namespace
{

Matrix3d cross_matrix(const Vec3d& a)
{
    return {0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0};
}

/// Rodrigues: the turn by `angle` about the unit axis.
Matrix3d turn(const Vec3d& axis, double angle)
{
    const Matrix3d k = cross_matrix(axis);
    Matrix3d m;
    return m + k * std::sin(angle) + (outer(axis, axis) - Matrix3d()) * (1.0 - std::cos(angle));
}

/// The farthest that points of the box lie from `p`; infinite for an infinite box.
double reach(const Box3d& box, const Vec3d& p)
{
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double d = std::max(std::abs(box.min[k] - p[k]), std::abs(box.max[k] - p[k]));
        sum += d * d;
    }
    return std::sqrt(sum);
}

class Rotation final : public Flow
{
public:
    Rotation(const Vec3d& centre, const Vec3d& axis) : centre_(centre), axis_(axis) {}
    Vec3d velocity(const Vec3d& p, double) const override { return axis_.cross(p - centre_); }
    Matrix3d gradient(const Vec3d&, double) const override { return cross_matrix(axis_); }
    FlowBound bound(const Box3d& box, const Interval&) const override { return {reach(box, centre_), 1.0, 0.0, 0.0}; }
    bool closed_form() const override { return true; }
    Carried carry(const Vec3d& p, double t) const override
    {
        const Matrix3d m = turn(axis_, t);
        return {centre_ + apply(m, p - centre_), m};
    }

private:
    Vec3d centre_, axis_;
};

class Vortex final : public Flow
{
public:
    Vortex(const Vec3d& centre, const Vec3d& axis, double radius) : centre_(centre), axis_(axis), radius_(radius) {}
    Vec3d velocity(const Vec3d& p, double) const override
    {
        const Vec3d q = p - centre_;
        return axis_.cross(q) * turning(q);
    }
    Matrix3d gradient(const Vec3d& p, double) const override
    {
        const Vec3d q = p - centre_;
        return cross_matrix(axis_) * turning(q) + outer(axis_.cross(q), turning_gradient(q));
    }
    FlowBound bound(const Box3d&, const Interval&) const override { return {radius_ * 0.4290, 1.0, 1.96 / radius_, 0.0}; }
    bool closed_form() const override { return true; }
    Carried carry(const Vec3d& p, double t) const override
    {
        const Vec3d q = p - centre_;
        const Matrix3d m = turn(axis_, t * turning(q));
        const Vec3d moved = apply(m, q);
        return {centre_ + moved, m + outer(axis_.cross(moved), turning_gradient(q) * t)};
    }

private:
    double turning(const Vec3d& q) const
    {
        const Vec3d across = q - axis_ * axis_.dot(q);
        return std::exp(-across.length2() / (radius_ * radius_));
    }
    Vec3d turning_gradient(const Vec3d& q) const
    {
        const Vec3d across = q - axis_ * axis_.dot(q);
        return across * (-2.0 / (radius_ * radius_) * turning(q));
    }
    Vec3d centre_, axis_;
    double radius_;
};

class Bulge final : public Flow
{
public:
    Bulge(const Vec3d& centre, double radius) : centre_(centre), radius_(radius) {}
    Vec3d velocity(const Vec3d& p, double) const override
    {
        const Vec3d q = p - centre_;
        return q * std::max(0.0, 1.0 - share(q));
    }
    Matrix3d gradient(const Vec3d& p, double) const override
    {
        const Vec3d q = p - centre_;
        const double u = share(q);
        if (!(u < 1.0)) return Matrix3d() * 0.0;
        return Matrix3d() * (1.0 - u) - outer(q, q) * (2.0 / (radius_ * radius_));
    }
    FlowBound bound(const Box3d& box, const Interval&) const override
    {
        double near = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double d = std::max({0.0, box.min[k] - centre_[k], centre_[k] - box.max[k]});
            near += d * d;
        }
        if (near >= radius_ * radius_) return {};
        const bool across = !(reach(box, centre_) < radius_);
        return {radius_ * 0.3850, 2.0, across ? kInfinity : 6.0 / radius_, 0.0};
    }
    bool closed_form() const override { return true; }
    Carried carry(const Vec3d& p, double t) const override
    {
        const Vec3d q = p - centre_;
        const double u = share(q);
        if (!(u < 1.0)) return {p, Matrix3d()};
        // |q| grows by sqrt(E / (1 + u (E - 1))), and that factor changes with q by u alone.
        const double e = std::exp(2.0 * t), below = 1.0 + u * (e - 1.0), factor = std::sqrt(e / below);
        const Vec3d along = q * (-factor * (e - 1.0) / (below * radius_ * radius_));
        return {centre_ + q * factor, Matrix3d() * factor + outer(q, along)};
    }

private:
    double share(const Vec3d& q) const { return q.length2() / (radius_ * radius_); }
    Vec3d centre_;
    double radius_;
};

class Shear final : public Flow
{
public:
    Shear(const Vec3d& centre, const Vec3d& normal, const Vec3d& along) : centre_(centre), normal_(normal), along_(along) {}
    Vec3d velocity(const Vec3d& p, double) const override { return along_ * normal_.dot(p - centre_); }
    Matrix3d gradient(const Vec3d&, double) const override { return outer(along_, normal_); }
    FlowBound bound(const Box3d& box, const Interval&) const override { return {reach(box, centre_), 1.0, 0.0, 0.0}; }
    bool closed_form() const override { return true; }
    Carried carry(const Vec3d& p, double t) const override
    {
        return {p + along_ * (t * normal_.dot(p - centre_)), Matrix3d() + outer(along_, normal_) * t};
    }

private:
    Vec3d centre_, normal_, along_;
};

class Vertical final : public Flow
{
public:
    Vertical(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed, const std::optional<DetailView>& view)
        : origin_(origin), wavelength_(wavelength), seed_(seed), fractal_{static_cast<double>(octaves), 2.0, gain}, fades_(view)
    {
        double amplitude = 1.0, frequency = 1.0 / wavelength;
        for (int k = 0; k < octaves; ++k, amplitude *= gain, frequency *= 2.0) {
            octaves_.push_back({FadingOctave(view, 1.0 / frequency, 2),
                                {amplitude * kNoise2Bound.value, amplitude * frequency * kNoise2Derivatives.slope,
                                 amplitude * frequency * frequency * kNoise2Derivatives.hessian, 0.0}});
        }
    }
    Vec3d velocity(const Vec3d& p, double) const override { return {0.0, 0.0, height(p).value}; }
    Matrix3d gradient(const Vec3d& p, double) const override
    {
        const Noise2 n = height(p);
        return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, n.gradient.x, n.gradient.y, 0.0};
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
    bool closed_form() const override { return true; }
    Carried carry(const Vec3d& p, double t) const override
    {
        const Noise2 n = height(p);
        return {p + Vec3d(0.0, 0.0, t * n.value), {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, t * n.gradient.x, t * n.gradient.y, 1.0}};
    }

private:
    struct Octave {
        FadingOctave fading;
        FlowBound alone;
    };
    Noise2 height(const Vec3d& p) const
    {
        const Vec2d q = Vec2d(p.x - origin_.x, p.y - origin_.y) * (1.0 / wavelength_);
        Noise2 sum;
        if (!fades_) {
            sum = fbm(q, seed_, fractal_);
            sum.gradient *= 1.0 / wavelength_;
            return sum;
        }
        for (std::size_t k = 0; k < octaves_.size(); ++k) {
            const DetailFade::Weight w = octaves_[k].fading.weight(p);
            if (w.value == 0.0) continue;
            const Noise2 n = fbm_octave(q, seed_, fractal_, static_cast<int>(k));
            sum.value += w.value * n.value;
            sum.gradient += n.gradient * (w.value / wavelength_) + Vec2d(w.gradient.x, w.gradient.y) * n.value;
        }
        return sum;
    }
    Vec3d origin_;
    double wavelength_;
    std::uint32_t seed_;
    Fractal fractal_;
    bool fades_;
    std::vector<Octave> octaves_;
};

}  // namespace

FlowPtr rotation_flow(const Vec3d& centre, const Vec3d& axis)
{
    return std::make_shared<Rotation>(centre, axis.normalized());
}

FlowPtr vortex_flow(const Vec3d& centre, const Vec3d& axis, double radius)
{
    return std::make_shared<Vortex>(centre, axis.normalized(), radius);
}

FlowPtr bulge_flow(const Vec3d& centre, double radius)
{
    return std::make_shared<Bulge>(centre, radius);
}

FlowPtr shear_flow(const Vec3d& centre, const Vec3d& normal, const Vec3d& direction)
{
    const Vec3d n = normal.normalized();
    return std::make_shared<Shear>(centre, n, (direction - n * n.dot(direction)).normalized());
}

FlowPtr vertical_flow(const Vec3d& origin, double wavelength, int octaves, double gain, std::uint32_t seed, const std::optional<DetailView>& view)
{
    return std::make_shared<Vertical>(origin, wavelength, octaves, gain, seed, view);
}

}  // namespace hoodoo
